// The kernels of tile_gaussian.cpp; see tile_rows-inl.h.
#include "engine/filter/tile_rows-inl.h"

constexpr int kGroup = 4;  // rows of outputs at once, which share the samples that are widened

#if FETTLE_LEVEL == 2

// The lanes kBy .. kBy + 7 of `a` and then `b`, kBy in 0 .. 8.
template <int kBy>
FETTLE_INLINE __m512d from(__m512d a, __m512d b) noexcept {
  if constexpr (kBy == 0) return a;
  if constexpr (kBy == 8) return b;
  return _mm512_castsi512_pd(_mm512_alignr_epi64(_mm512_castpd_si512(b), _mm512_castpd_si512(a), kBy & 7));
}

// Sums down eight columns, for a group of rows.
struct Down {
  __m512d sum[kGroup];
};

template <int kRadius>
FETTLE_INLINE Down downOf(const TileRows<kRadius>& rows, const __m512d* w, int y, int eight) noexcept {
  Down down;
#pragma GCC unroll 16
  for (int i = 0; i < kGroup + 2 * kRadius; ++i) {
    const __m512d x = _mm512_cvtps_pd(_mm256_loadu_ps(rows.at(y + i - kRadius, 8 * eight)));
#pragma GCC unroll 4
    for (int j = 0; j < kGroup; ++j) {
      const int k = i - j < kRadius ? kRadius - (i - j) : i - j - kRadius;
      if (i < j || k > kRadius) continue;
      // The first product is rounded as its sum with 0 is.
      down.sum[j] = i == j ? _mm512_mul_pd(w[k], x) : _mm512_fmadd_pd(w[k], x, down.sum[j]);
    }
  }
  return down;
}

// The sum along the row, first sample to last.
template <int kRadius, std::size_t... kIndex>
FETTLE_INLINE __m512d along(__m512d before, __m512d here, __m512d after, const __m512d* w,
                            std::index_sequence<kIndex...>) noexcept {
  __m512d sum = _mm512_mul_pd(w[kRadius], from<8 - kRadius>(before, here));
  const auto add = [&]<int kAt>(std::integral_constant<int, kAt>) {
    if constexpr (kAt < kRadius)
      sum = _mm512_fmadd_pd(w[kRadius - kAt], from<8 - kRadius + kAt>(before, here), sum);
    else
      sum = _mm512_fmadd_pd(w[kAt - kRadius], from<kAt - kRadius>(here, after), sum);
  };
  (add(std::integral_constant<int, static_cast<int>(kIndex) + 1>{}), ...);
  return sum;
}

template <int kRadius>
void gaussianTile(const TileAround& around, const double* weights, double inverse, float* out) noexcept {
  const TileRows<kRadius> rows(around);
  __m512d w[kRadius + 1];
  for (int k = 0; k <= kRadius; ++k) w[k] = _mm512_set1_pd(weights[k]);
  const __m512d whole = _mm512_set1_pd(inverse);
  for (int y = 0; y < kTileSide; y += kGroup) {
    Down before = downOf(rows, w, y, -1), here = downOf(rows, w, y, 0);
#pragma GCC unroll 8
    for (int k = 0; k < kTileSide / 8; ++k) {
      const Down after = downOf(rows, w, y, k + 1);
#pragma GCC unroll 4
      for (int j = 0; j < kGroup; ++j) {
        const __m512d sum = along<kRadius>(before.sum[j], here.sum[j], after.sum[j], w,
                                           std::make_index_sequence<2 * kRadius>());
        _mm256_store_ps(out + (y + j) * kTileSide + 8 * k, _mm512_cvtpd_ps(_mm512_mul_pd(sum, whole)));
      }
      before = here;
      here = after;
    }
  }
}

#elif FETTLE_LEVEL == 1

// With 16 registers the sums down wait in the nearest cache for the pass along: shifting lanes would leave too few for the sums.
template <int kRadius>
void gaussianTile(const TileAround& around, const double* weights, double inverse, float* out) noexcept {
  const TileRows<kRadius> rows(around);
  Pack w[kRadius + 1];
  for (int k = 0; k <= kRadius; ++k) w[k] = every(weights[k]);
  const Pack whole = every(inverse);
  alignas(64) double down[kGroup][kTileSide + 2 * kPack];  // from column -kPack on
  for (int y = 0; y < kTileSide; y += kGroup) {
    for (int c = -kPack; c < kTileSide + kPack; c += kPack) {
      Pack sum[kGroup];
#pragma GCC unroll 16
      for (int i = 0; i < kGroup + 2 * kRadius; ++i) {
        const Pack x = widened(load<HalfPack>(rows.at(y + i - kRadius, c)));
#pragma GCC unroll 4
        for (int j = 0; j < kGroup; ++j) {
          const int k = i - j < kRadius ? kRadius - (i - j) : i - j - kRadius;
          if (i < j || k > kRadius) continue;
          sum[j] = i == j ? w[k] * x : fused(w[k], x, sum[j]);
        }
      }
#pragma GCC unroll 4
      for (int j = 0; j < kGroup; ++j) store(down[j] + c + kPack, sum[j]);
    }
    for (int j = 0; j < kGroup; ++j)
      for (int c = 0; c < kTileSide; c += kPack) {
        const double* const from = down[j] + c + kPack - kRadius;
        Pack sum = w[kRadius] * load<Pack>(from);
#pragma GCC unroll 8
        for (int i = 1; i <= 2 * kRadius; ++i)
          sum = fused(w[i < kRadius ? kRadius - i : i - kRadius], load<Pack>(from + i), sum);
        store(out + (y + j) * kTileSide + c, narrowed(sum * whole));
      }
  }
}

#endif
