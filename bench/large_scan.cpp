#include "bench/large_scan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <vector>

#include "bench/repeats.h"
#include "engine/io/files/little_endian.h"

namespace fettle::bench {

namespace {

static_assert(std::endian::native == std::endian::little, "the file is written in the machine's order");

constexpr std::int32_t kStripRows = 64;
constexpr std::uint64_t kFirstSample = 4096;

// The directory of a BigTIFF, in the order of its tags; values that do not fit into an entry follow it.
class Directory {
 public:
  explicit Directory(std::uint64_t at) : at_(at) {}

  template <class T>
  void add(std::uint16_t tag, std::uint16_t type, const std::vector<T>& values) {
    Entry entry{tag, type, values.size(), {}};
    for (const T& value : values) engine::appendLittle(entry.bytes, value);
    entries_.push_back(std::move(entry));
  }

  [[nodiscard]] std::string bytes() const {
    std::string head;
    std::string rest;
    const std::uint64_t count = entries_.size();
    engine::appendLittle(head, count);
    const std::uint64_t rest_at = at_ + 8 + 20 * count + 8;
    for (const Entry& entry : entries_) {
      engine::appendLittle(head, entry.tag);
      engine::appendLittle(head, entry.type);
      engine::appendLittle(head, entry.count);
      if (entry.bytes.size() <= 8) {
        head.append(entry.bytes);
        head.append(8 - entry.bytes.size(), '\0');
        continue;
      }
      engine::appendLittle(head, rest_at + rest.size());
      rest.append(entry.bytes);
      rest.append((8 - rest.size() % 8) % 8, '\0');
    }
    engine::appendLittle(head, std::uint64_t{0});  // no other directory
    return head + rest;
  }

 private:
  struct Entry {
    std::uint16_t tag, type;
    std::uint64_t count;
    std::string bytes;
  };

  std::uint64_t at_;
  std::vector<Entry> entries_;
};

std::string directoryOf(std::int32_t side, std::uint64_t at) {
  constexpr std::uint16_t kShort = 3, kLong = 4, kDouble = 12, kLong8 = 16;
  const auto side_bits = static_cast<std::uint32_t>(side);
  std::vector<std::uint64_t> offsets, counts;
  for (std::int32_t row = 0; row < side; row += kStripRows) {
    offsets.push_back(kFirstSample + largeScanBytes(1) * side_bits * static_cast<std::uint64_t>(row));
    counts.push_back(largeScanBytes(1) * side_bits *
                     static_cast<std::uint64_t>(std::min(kStripRows, side - row)));
  }
  const auto one = [](std::uint16_t value) { return std::vector<std::uint16_t>{value}; };
  Directory directory(at);
  directory.add<std::uint32_t>(256, kLong, {side_bits});
  directory.add<std::uint32_t>(257, kLong, {side_bits});
  directory.add(258, kShort, one(32));  // bits
  directory.add(259, kShort, one(1));   // not compressed
  directory.add(262, kShort, one(1));   // black is low
  directory.add(273, kLong8, offsets);
  directory.add(277, kShort, one(1));  // one sample per pixel
  directory.add<std::uint32_t>(278, kLong, {kStripRows});
  directory.add(279, kLong8, counts);
  directory.add(339, kShort, one(3));  // floats
  directory.add<double>(33550, kDouble, {kSpacingMm, kSpacingMm, 0.0});
  directory.add<double>(33922, kDouble, {0.0, 0.0, 0.0, 0.0, kSpacingMm * side, 0.0});
  // GeoKeys 1.1.0 with one key: pixels are areas.
  directory.add<std::uint16_t>(34735, kShort, {1, 1, 0, 1, 1025, 0, 1, 1});
  return directory.bytes();
}

}  // namespace

engine::Status writeLargeScan(const std::string& path, std::int32_t side, engine::JobControl& job) {
  const auto cannot = [&path] {
    return engine::inputError("the scan cannot be written", path, "the disk may be full");
  };
  std::ofstream file;
  file.rdbuf()->pubsetbuf(nullptr, 0);  // strips are large
  file.open(path, std::ios::binary | std::ios::trunc);

  const std::uint64_t directory_at = kFirstSample + largeScanBytes(side);
  std::string head(kFirstSample, '\0');
  std::memcpy(head.data(), "II\x2b\0\x8\0\0\0", 8);
  std::memcpy(head.data() + 8, &directory_at, sizeof directory_at);
  file.write(head.data(), static_cast<std::streamsize>(head.size()));

  // Products of a function of the column and one of the row: a multiplication where workpiece() takes a sine.
  const auto n = static_cast<std::size_t>(side);
  std::vector<float> steps(n), waves(n), ribs(n);
  for (std::size_t c = 0; c < n; ++c) {
    const double x = static_cast<double>(c) * kSpacingMm;
    steps[c] = static_cast<float>(8.0 * std::sin(x * 0.31));
    waves[c] = static_cast<float>(0.8 * std::sin(x * 0.4));
    ribs[c] = static_cast<float>(std::max(0.0, 0.4 - std::abs(std::fmod(x, 7.85) - 3.9)));
  }
  std::vector<float> strip(n * kStripRows);
  std::uint64_t state = 0x9e3779b97f4a7c15;
  job.begin("making the scan", static_cast<std::uint64_t>(side));
  for (std::int32_t row = 0; row < side && file; row += kStripRows) {
    const std::int32_t rows = std::min(kStripRows, side - row);
    for (std::int32_t r = 0; r < rows; ++r) {
      const double y = (row + r) * kSpacingMm;
      const auto step = static_cast<float>(std::sin(y * 0.23));
      const auto wave = static_cast<float>(std::cos(y * 0.3));
      float* z = strip.data() + static_cast<std::size_t>(r) * n;
      for (std::size_t c = 0; c < n; ++c) {
        // Marsaglia 2003, xorshift64.
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        const float noise = (static_cast<float>(state >> 40) * 0x1p-24F - 0.5F) * 0.04F;
        z[c] = std::clamp(steps[c] * step, -0.5F, 0.5F) + ribs[c] + waves[c] * wave + noise;
      }
    }
    file.write(reinterpret_cast<const char*>(strip.data()),
               static_cast<std::streamsize>(n * static_cast<std::size_t>(rows) * sizeof(float)));
    if (job.cancelled()) return engine::cancelled();
    job.advance(static_cast<std::uint64_t>(rows));
  }
  const std::string directory = directoryOf(side, directory_at);
  file.write(directory.data(), static_cast<std::streamsize>(directory.size()));
  file.close();
  if (!file) return cannot();
  return {};
}

}  // namespace fettle::bench
