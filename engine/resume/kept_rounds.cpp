#include "engine/resume/kept_rounds.h"

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

#include <xxhash.h>

namespace fettle::engine {

namespace {

constexpr std::string_view kRoundsMagic("FTLROUND", 8);

// The beginning of the file; the identity, the numbers and a checksum of all of it follow. Little endian.
struct RoundsHead {
  char magic[8];
  std::uint32_t version = 1;
  std::int32_t pass = 0;
  std::int32_t done = 0;
  std::uint32_t identity_bytes = 0;
  double limit = 0.0;
  std::uint64_t number_bytes = 0;
};
static_assert(sizeof(RoundsHead) == 40);

// Of the parts, one after the other.
std::uint64_t sumOf(const RoundsHead& head, std::string_view identity, std::string_view numbers) {
  const std::uint64_t of_head = XXH64(&head, sizeof head, 0);
  return XXH64(numbers.data(), numbers.size(), XXH64(identity.data(), identity.size(), of_head));
}

}  // namespace

std::optional<FilterWork::Rounds> KeptRounds::read(int pass) const {
  std::error_code unknown;
  const std::uint64_t size = std::filesystem::file_size(path_, unknown);
  std::ifstream file(path_, std::ios::binary);
  RoundsHead head;
  if (unknown || !file.read(reinterpret_cast<char*>(&head), sizeof head)) return std::nullopt;
  if (std::string_view(head.magic, sizeof head.magic) != kRoundsMagic || head.version != 1 ||
      head.pass != pass || head.identity_bytes != identity_.size() ||
      size != sizeof head + head.identity_bytes + head.number_bytes + sizeof(std::uint64_t))
    return std::nullopt;
  std::string identity(head.identity_bytes, '\0');
  FilterWork::Rounds rounds{head.done, head.limit, std::string(head.number_bytes, '\0')};
  std::uint64_t sum = 0;
  file.read(identity.data(), static_cast<std::streamsize>(identity.size()));
  file.read(rounds.numbers.data(), static_cast<std::streamsize>(rounds.numbers.size()));
  file.read(reinterpret_cast<char*>(&sum), sizeof sum);
  if (!file || identity != identity_ || sum != sumOf(head, identity, rounds.numbers)) return std::nullopt;
  return rounds;
}

Status KeptRounds::keep(int pass, const FilterWork::Rounds& rounds) const {
  RoundsHead head;
  std::memcpy(head.magic, kRoundsMagic.data(), sizeof head.magic);
  head.pass = pass;
  head.done = rounds.done;
  head.identity_bytes = static_cast<std::uint32_t>(identity_.size());
  head.limit = rounds.limit;
  head.number_bytes = rounds.numbers.size();
  const std::uint64_t sum = sumOf(head, identity_, rounds.numbers);
  // One name for the new file, which a crash may leave: the next one is written over it. Not flushed to the disk: what a power
  // cut damages is seen by its sum, and those rounds are worked out again.
  const std::string fresh = path_ + ".new";
  std::ofstream file(fresh, std::ios::binary | std::ios::trunc);
  const auto bytesOf = [](const auto& value) {
    return std::string_view(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const std::string_view part :
       {bytesOf(head), std::string_view(identity_), std::string_view(rounds.numbers), bytesOf(sum)})
    file.write(part.data(), static_cast<std::streamsize>(part.size()));
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(fresh, path_, error);
  if (file && !error) return {};
  std::error_code ignored;
  std::filesystem::remove(fresh, ignored);
  return failure("the rounds of a filter could not be written", path_, "free space on the disk");
}

void KeptRounds::remove() const noexcept {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  std::filesystem::remove(path_ + ".new", ignored);
}

}  // namespace fettle::engine
