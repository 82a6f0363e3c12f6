#include "engine/session/checksum.h"

#include <bit>
#include <memory>
#include <vector>

#include <sys/stat.h>
#include <xxhash.h>

#include "engine/io/files/input_file.h"

namespace fettle::engine {

RowChecksum& RowChecksum::integer(std::int64_t value) {
  const auto bits = static_cast<std::uint64_t>(value);
  for (int k = 0; k < 8; ++k) bytes_.push_back(static_cast<char>(bits >> (8 * k)));
  return *this;
}

RowChecksum& RowChecksum::real(double value) {
  return integer(std::bit_cast<std::int64_t>(value + 0.0));  // SQLite does not keep the sign of a zero
}

RowChecksum& RowChecksum::text(std::string_view value) {
  integer(static_cast<std::int64_t>(value.size()));
  bytes_.append(value);
  return *this;
}

RowChecksum& RowChecksum::null() {
  return integer(-1);
}

std::int64_t RowChecksum::value() const noexcept {
  return static_cast<std::int64_t>(XXH64(bytes_.data(), bytes_.size(), 0));
}

Result<FileChecksum> fileChecksum(const std::string& path) {
  const Result<InputFile> file = InputFile::open(path);
  if (!file) return tl::unexpected(file.error());
  const std::unique_ptr<XXH64_state_t, decltype(&XXH64_freeState)> state(XXH64_createState(),
                                                                         XXH64_freeState);
  if (!state) return failure("memory could not be allocated", path);
  XXH64_reset(state.get(), 0);
  std::vector<char> piece(std::size_t{1} << 20);
  FileChecksum sum;
  for (;;) {
    const Result<std::size_t> got = file->read(sum.bytes, piece.data(), piece.size());
    if (!got) return tl::unexpected(got.error());
    if (*got == 0) break;
    XXH64_update(state.get(), piece.data(), *got);
    sum.bytes += *got;
  }
  sum.xxh64 = XXH64_digest(state.get());
  return sum;
}

std::optional<FileStamp> fileStamp(const std::string& path) {
  struct stat file {};
  if (stat(path.c_str(), &file) != 0) return std::nullopt;
  return FileStamp{static_cast<std::uint64_t>(file.st_dev), static_cast<std::uint64_t>(file.st_ino),
                   static_cast<std::uint64_t>(file.st_size),
                   std::int64_t{file.st_mtim.tv_sec} * 1'000'000'000 + file.st_mtim.tv_nsec};
}

}  // namespace fettle::engine
