#include "engine/field/tile.h"

#include <array>
#include <limits>

namespace fettle::engine {

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

constexpr int kLanes = 8;

// Comparisons with NaN are false, so a hole never replaces a bound: `v < lo ? v : lo` is the machine's packed
// minimum. A fixed number of lanes, so that the compiler vectorises it.
template <int kRows>
HeightBounds boundsOf(const float* low, const float* high, int stride) noexcept {
  std::array<float, kLanes> lo;
  std::array<float, kLanes> hi;
  lo.fill(kInf);
  hi.fill(-kInf);
  for (int r = 0; r < kRows; ++r)
    for (int c = 0; c < kLanes; ++c) {
      const float a = low[r * stride + c];
      const float b = high[r * stride + c];
      lo[c] = a < lo[c] ? a : lo[c];
      hi[c] = b > hi[c] ? b : hi[c];
    }
  for (int half = kLanes / 2; half > 0; half /= 2)
    for (int c = 0; c < half; ++c) {
      lo[c] = lo[c + half] < lo[c] ? lo[c + half] : lo[c];
      hi[c] = hi[c + half] > hi[c] ? hi[c + half] : hi[c];
    }
  return {lo[0], hi[0]};
}

HeightBounds blockBounds(const Tile& tile, int block_column, int block_row) noexcept {
  const float* samples = tile.samples.data() + (block_row * kTileSide + block_column) * kBlockSide;
  return boundsOf<kBlockSide>(samples, samples, kTileSide);
}

HeightBounds tileBounds(const Tile& tile) noexcept {
  return boundsOf<kFanOut / kLanes>(tile.block_min.data(), tile.block_max.data(), kLanes);
}

}  // namespace

void refreshBounds(Tile& tile, int column0, int row0, int column1, int row1) noexcept {
  for (int br = row0 / kBlockSide; br * kBlockSide < row1; ++br)
    for (int bc = column0 / kBlockSide; bc * kBlockSide < column1; ++bc) {
      const HeightBounds b = blockBounds(tile, bc, br);
      tile.block_min[br * 8 + bc] = b.min;
      tile.block_max[br * 8 + bc] = b.max;
    }
  refreshTileBounds(tile);
}

void refreshTileBounds(Tile& tile) noexcept {
  tile.bounds = tileBounds(tile);
}

bool refreshSampleBounds(Tile& tile, int column, int row, float old) noexcept {
  const std::size_t k = static_cast<std::size_t>(row / kBlockSide * 8 + column / kBlockSide);
  const float now = tile.samples[static_cast<std::size_t>(row * kTileSide + column)];
  // Neither the old sample nor the new one is a bound, none is a hole: most edits end here.
  if (old > tile.block_min[k] && old < tile.block_max[k] && now > tile.block_min[k] &&
      now < tile.block_max[k])
    return false;
  const HeightBounds b = blockBounds(tile, column / kBlockSide, row / kBlockSide);
  if (b.min == tile.block_min[k] && b.max == tile.block_max[k]) return false;
  tile.block_min[k] = b.min;
  tile.block_max[k] = b.max;
  const HeightBounds before = tile.bounds;
  tile.bounds = tileBounds(tile);
  return !(tile.bounds == before);
}

void refreshMarks(Tile& tile) noexcept {
  // Mostly there is none, and counting bits takes a call where the processor is not known to do it.
  std::uint64_t any = 0;
  for (const std::uint64_t row : tile.marks) any |= row;
  std::uint32_t n = 0;
  if (any != 0)
    for (const std::uint64_t row : tile.marks) n += static_cast<std::uint32_t>(std::popcount(row));
  tile.marked_samples = n;
}

}  // namespace fettle::engine
