#include "engine/filter/middle_distance.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "engine/field/tile.h"

namespace fettle::engine {

namespace {

// Bits of a float of no sign are ordered as it is: ranks are found by the upper half, then by the lower half of those with
// the same upper one.
constexpr std::size_t kHalves = std::size_t{1} << 16;
using DistanceCounts = std::vector<std::int64_t>;

DistanceCounts counted(const FieldReader& field, const float* surface, std::ptrdiff_t stride, auto&& binOf) {
  tbb::enumerable_thread_specific<DistanceCounts> parts([] { return DistanceCounts(kHalves); });
  tbb::parallel_for(std::int32_t{0}, field.tileRows(), [&](std::int32_t tr) {
    DistanceCounts& mine = parts.local();
    std::array<float, kTileSamples> z;
    const std::int32_t row = tr * kTileSide, rows = std::min(kTileSide, field.height() - row);
    for (std::int32_t column = 0; column < field.width(); column += kTileSide) {
      const std::int32_t columns = std::min(kTileSide, field.width() - column);
      field.readHeights(column, row, columns, rows, z.data(), kTileSide);
      for (std::int32_t r = 0; r < rows; ++r)
        for (std::int32_t c = 0; c < columns; ++c) {
          const float height = z[static_cast<std::size_t>(r * kTileSide + c)];
          if (height != height) continue;
          const auto distance = static_cast<float>(std::fabs(
              static_cast<double>(height) - static_cast<double>(surface[(row + r) * stride + column + c])));
          if (const std::int32_t bin = binOf(std::bit_cast<std::uint32_t>(distance)); bin >= 0)
            ++mine[static_cast<std::size_t>(bin)];
        }
    }
  });
  DistanceCounts all(kHalves);
  for (const DistanceCounts& part : parts)
    for (std::size_t i = 0; i < kHalves; ++i) all[i] += part[i];
  return all;
}

// The bin of the rank-th from below, whose rank within the bin is left in `rank`.
std::uint32_t binOfRank(const DistanceCounts& counts, std::int64_t& rank) {
  for (std::uint32_t bin = 0; bin + 1 < kHalves; ++bin) {
    if (rank < counts[bin]) return bin;
    rank -= counts[bin];
  }
  return kHalves - 1;
}

}  // namespace

double middleDistance(const FieldReader& field, const float* surface, std::ptrdiff_t stride) {
  const DistanceCounts upper = counted(
      field, surface, stride, [](std::uint32_t bits) { return static_cast<std::int32_t>(bits >> 16); });
  std::int64_t samples = 0;
  for (const std::int64_t n : upper) samples += n;
  if (samples == 0) return 0.0;
  double middle = 0.0;
  std::uint32_t last = 0;
  DistanceCounts lower;
  for (const std::int64_t which : {(samples - 1) / 2, samples / 2}) {
    std::int64_t rank = which;
    const std::uint32_t high = binOfRank(upper, rank);
    if (lower.empty() || high != last)
      lower = counted(field, surface, stride, [high](std::uint32_t bits) {
        return bits >> 16 == high ? static_cast<std::int32_t>(bits & 0xFFFFU) : -1;
      });
    last = high;
    const std::uint32_t low = binOfRank(lower, rank);
    middle += 0.5 * static_cast<double>(std::bit_cast<float>(high << 16 | low));
  }
  return middle;
}

}  // namespace fettle::engine
