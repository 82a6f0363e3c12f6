#include "engine/field/tile.h"

#include <limits>

namespace fettle::engine {

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

// Comparisons with NaN are false, so a hole never replaces a bound: `v < lo ? v : lo` is what the machine's
// packed minimum does, and the compiler sees that.
HeightBounds boundsOf(const float* samples, int stride) noexcept {
  float lo = kInf;
  float hi = -kInf;
  for (int r = 0; r < kBlockSide; ++r)
    for (int c = 0; c < kBlockSide; ++c) {
      const float v = samples[r * stride + c];
      lo = v < lo ? v : lo;
      hi = v > hi ? v : hi;
    }
  return {lo, hi};
}

}  // namespace

void refreshBounds(Tile& tile, int column0, int row0, int column1, int row1) noexcept {
  for (int br = row0 / kBlockSide; br * kBlockSide < row1; ++br)
    for (int bc = column0 / kBlockSide; bc * kBlockSide < column1; ++bc) {
      const HeightBounds b = boundsOf(tile.samples.data() + (br * kTileSide + bc) * kBlockSide, kTileSide);
      tile.block_min[br * 8 + bc] = b.min;
      tile.block_max[br * 8 + bc] = b.max;
    }
  float lo = kInf;
  float hi = -kInf;
  for (int k = 0; k < kFanOut; ++k) {
    lo = tile.block_min[k] < lo ? tile.block_min[k] : lo;
    hi = tile.block_max[k] > hi ? tile.block_max[k] : hi;
  }
  tile.bounds = {lo, hi};
}

void refreshMarks(Tile& tile) noexcept {
  std::uint32_t n = 0;
  for (const std::uint64_t row : tile.marks) n += static_cast<std::uint32_t>(std::popcount(row));
  tile.marked_samples = n;
}

}  // namespace fettle::engine
