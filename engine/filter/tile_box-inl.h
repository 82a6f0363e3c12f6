// The kernels of tile_box.cpp; see tile_rows-inl.h.
#include "engine/filter/tile_rows-inl.h"
#if FETTLE_LEVEL == 1

// Bits of the least magnitude, but for 0, and of the largest one of all samples that windows reach.
template <int kRadius>
FETTLE_INLINE Magnitudes magnitudesOf(const TileRows<kRadius>& rows) noexcept {
  const __m256i size = _mm256_set1_epi32(0x7fffffff), one = _mm256_set1_epi32(1);
  // The first and the last eight columns are the tiles' beside, of which windows reach kRadius columns.
  const __m256i lane = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  const __m256i left = _mm256_and_si256(size, _mm256_cmpgt_epi32(lane, _mm256_set1_epi32(7 - kRadius)));
  const __m256i right = _mm256_and_si256(size, _mm256_cmpgt_epi32(_mm256_set1_epi32(kRadius), lane));
  __m256i least = _mm256_set1_epi32(-1), most = _mm256_setzero_si256();
  const auto take = [&](const float* from, const __m256i& mask) __attribute__((always_inline)) {
    const __m256i bits = _mm256_and_si256(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(from)), mask);
    least = _mm256_min_epu32(least, _mm256_sub_epi32(bits, one));
    most = _mm256_max_epu32(most, bits);
  };
  for (int y = -kRadius; y < kTileSide + kRadius; ++y) {
    take(rows.at(y, -8), left);
    for (int c = 0; c < kTileSide; c += 8) take(rows.at(y, c), size);
    take(rows.at(y, kTileSide), right);
  }
  std::uint32_t low[8], high[8];
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(low), least);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(high), most);
  return {*std::ranges::min_element(low) + 1, *std::ranges::max_element(high)};
}

constexpr int kGroup = 4;  // rows of outputs at once, which share the samples that are widened

// Sums of 2 kRadius + 1 neighbours of x for a group.
template <int kRadius>
FETTLE_INLINE void sumsOf(const Pack* x, Pack* sums) noexcept {
  if constexpr (kRadius == 1) {
    const Pack upper = x[1] + x[2], lower = x[3] + x[4];
    sums[0] = x[0] + upper;
    sums[1] = upper + x[3];
    sums[2] = x[2] + lower;
    sums[3] = lower + x[5];
  } else {
    const Pack middle = x[3] + x[4], upper = x[1] + x[2], lower = x[5] + x[6];
    sums[0] = (x[0] + upper) + middle;
    sums[1] = (upper + middle) + x[5];
    sums[2] = (x[2] + middle) + lower;
    sums[3] = (middle + lower) + x[7];
  }
}

// Sums in kLanes lanes, which hold all of every sample: exact in any order.
template <int kRadius, int kLanes>
void boxTile(const TileAround& around, double cut, float* out) noexcept {
  constexpr int kWindow = 2 * kRadius + 1, kRows = kGroup + 2 * kRadius;
  const TileRows<kRadius> rows(around);
  const Pack at = every(cut), count = every(kWindow * kWindow), inverse = every(1.0 / (kWindow * kWindow));
  alignas(64) double down[kLanes][kGroup][kTileSide + 2 * kPack];  // from column -kPack on
  for (int y = 0; y < kTileSide; y += kGroup) {
    for (int c = -kPack; c < kTileSide + kPack; c += kPack) {
      Pack lanes[kLanes][kRows];
#pragma GCC unroll 8
      for (int i = 0; i < kRows; ++i) {
        const Pack x = widened(load<HalfPack>(rows.at(y + i - kRadius, c)));
        lanes[0][i] = kLanes == 1 ? x : (x + at) - at;
        if constexpr (kLanes == 2) lanes[1][i] = x - lanes[0][i];
      }
#pragma GCC unroll 2
      for (int l = 0; l < kLanes; ++l) {
        Pack sums[kGroup];
        sumsOf<kRadius>(lanes[l], sums);
#pragma GCC unroll 4
        for (int j = 0; j < kGroup; ++j) store(down[l][j] + c + kPack, sums[j]);
      }
    }
    for (int j = 0; j < kGroup; ++j)
      for (int c = 0; c < kTileSide; c += kPack) {
        Pack all{};
#pragma GCC unroll 2
        for (int l = 0; l < kLanes; ++l) {
          const double* const from = down[l][j] + c + kPack - kRadius;
          Pack sum = load<Pack>(from);
#pragma GCC unroll 8
          for (int i = 1; i < kWindow; ++i) sum += load<Pack>(from + i);
          all = l == 0 ? sum : all + sum;
        }
        // A division, as in box_integers-inl.h.
        const Pack q = all * inverse;
        store(out + (y + j) * kTileSide + c, narrowed(fused(fused(-q, count, all), inverse, q)));
      }
  }
}

template <int kRadius>
bool boxTileOf(const TileAround& around, float* out) noexcept {
  const BoxCuts cuts = cutsOf(magnitudesOf<kRadius>(TileRows<kRadius>(around)), 2 * kRadius + 1);
  if (cuts.lanes == 1)
    boxTile<kRadius, 1>(around, 0.0, out);
  else if (cuts.lanes == 2)
    boxTile<kRadius, 2>(around, cuts.first, out);
  return cuts.lanes != 0;
}

#endif
