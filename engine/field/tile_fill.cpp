#include "engine/field/tile_fill.h"

#include <bit>
#include <cstring>
#include <limits>

// Loops of fixed length over plain arrays, which the compiler vectorises. Compiled for AVX2 or AVX-512 as the kernels of
// filters are (engine/simd/kernel.h) they took 30 and 28 ms of processor time for 8192 x 8192 samples, with what every
// processor has 35: reading and clearing memory is most of it.

namespace fettle::engine {

namespace {

constexpr auto kHoleBits = std::bit_cast<std::int32_t>(std::numeric_limits<float>::quiet_NaN());

// On the bits, without a branch and with counts as wide as samples.
inline std::int32_t copyRow(const float* __restrict from, float* __restrict to, std::int32_t count) noexcept {
  std::int32_t infinite = 0;
  for (std::int32_t c = 0; c < count; ++c) {
    std::int32_t bits;
    std::memcpy(&bits, from + c, sizeof bits);
    const std::int32_t magnitude = bits & 0x7FFFFFFF;
    infinite += magnitude == 0x7F800000 ? 1 : 0;
    const std::int32_t kept = magnitude < 0x7F800000 ? bits : kHoleBits;
    std::memcpy(to + c, &kept, sizeof kept);
  }
  return infinite;
}

// Bounds of the 64 blocks, of two beside each other at once; returns how many samples are NaN. Lanes are halved as
// boundsOf() in bounds.cpp does: the bits are then those of an edit's, zeros of either sign included.
std::uint32_t blocksOf(const float* __restrict samples, float* __restrict block_min,
                       float* __restrict block_max) noexcept {
  constexpr int kTwo = 2 * kBlockSide;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::int32_t nan[kTwo] = {};
  for (int block = 0; block < kFanOut; block += 2) {
    const float* z = samples + block / 8 * kBlockSide * kTileSide + block % 8 * kBlockSide;
    float lo[kTwo], hi[kTwo];
    for (int c = 0; c < kTwo; ++c) {
      lo[c] = kInfinity;
      hi[c] = -kInfinity;
    }
    for (int r = 0; r < kBlockSide; ++r)
      for (int c = 0; c < kTwo; ++c) {
        const float v = z[r * kTileSide + c];
        lo[c] = v < lo[c] ? v : lo[c];
        hi[c] = v > hi[c] ? v : hi[c];
        nan[c] += v != v ? 1 : 0;
      }
    for (int of_two = 0; of_two < 2; ++of_two) {
      float* l = lo + kBlockSide * of_two;
      float* h = hi + kBlockSide * of_two;
      for (int half = kBlockSide / 2; half > 0; half /= 2)
        for (int c = 0; c < half; ++c) {
          l[c] = l[c + half] < l[c] ? l[c + half] : l[c];
          h[c] = h[c + half] > h[c] ? h[c + half] : h[c];
        }
      block_min[block + of_two] = l[0];
      block_max[block + of_two] = h[0];
    }
  }
  std::uint32_t count = 0;
  for (const std::int32_t lane : nan) count += static_cast<std::uint32_t>(lane);
  return count;
}

}  // namespace

std::int32_t copyHeights(const float* from, std::ptrdiff_t stride, float* to, std::int32_t columns,
                         std::int32_t rows) noexcept {
  std::int32_t infinite = 0;
  for (std::int32_t r = 0; r < rows; ++r, from += stride, to += kTileSide) {
    // The same row of the tile beside this one, which is mostly next: rows of 64 samples are too short for the
    // processor to prefetch them by itself. A prefetch past the array's end does nothing.
    for (int line = 0; line < kTileSide; line += 16) __builtin_prefetch(from + kTileSide + line);
    infinite += columns == kTileSide ? copyRow(from, to, kTileSide) : copyRow(from, to, columns);
  }
  return infinite;
}

void summariseTile(Tile& tile) noexcept {
  tile.nan_samples = blocksOf(tile.samples.data(), tile.block_min.data(), tile.block_max.data());
  refreshTileBounds(tile);
  refreshMarks(tile);
}

}  // namespace fettle::engine
