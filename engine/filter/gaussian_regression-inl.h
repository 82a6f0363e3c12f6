// The kernels of gaussian_regression.cpp; see each_cpu-inl.h. Products and sums are rounded each by itself, in the order of the
// taps, so that every level has the same bits.

#include "engine/filter/gaussian_slide-inl.h"

// Of one plane, the sums down by N orders.
template <int N>
FETTLE_INLINE void momentsDown(const double* in, std::ptrdiff_t stride, const double* up, int taps,
                               Pack* sums) noexcept {
  Pack sum[N] = {};
  for (int t = 0; t < taps; ++t, in += stride) {
    const Pack z = load<Pack>(in);
#pragma GCC unroll 5
    for (int k = 0; k < N; ++k) sum[k] += every(up[k * taps + t]) * z;
  }
#pragma GCC unroll 5
  for (int k = 0; k < N; ++k) sums[k] = sum[k];
}

// A row of heights. `planes`: eight planes `apart` elements from each other, by orders 0 to 4 along x of weights and 0 to 2 of weighted
// heights, at the first of `taps` rows; `up`: taps of orders 0 to 4, one order after the other.
inline void regressionRow(const double* planes, std::ptrdiff_t apart, std::ptrdiff_t stride, const double* up,
                          int taps, double least_weight, double least_determined, float* out,
                          int n) noexcept {
  constexpr int kTerms = 6;
  constexpr int kX[kTerms] = {0, 1, 0, 2, 1, 0}, kY[kTerms] = {0, 0, 1, 0, 1, 2};
  const Pack none = every(__builtin_nan(""));
  for (int i = 0; i < n; i += kPack) {
    Pack w[5][5], z[3][3];  // [order along x][along y]
    const double* const in = planes + i;
    momentsDown<5>(in, stride, up, taps, w[0]);
    momentsDown<4>(in + apart, stride, up, taps, w[1]);
    momentsDown<3>(in + 2 * apart, stride, up, taps, w[2]);
    momentsDown<2>(in + 3 * apart, stride, up, taps, w[3]);
    momentsDown<1>(in + 4 * apart, stride, up, taps, w[4]);
    momentsDown<3>(in + 5 * apart, stride, up, taps, z[0]);
    momentsDown<2>(in + 6 * apart, stride, up, taps, z[1]);
    momentsDown<1>(in + 7 * apart, stride, up, taps, z[2]);
    // The normal equations and their elimination.
    Pack a[kTerms][kTerms], b[kTerms], whole[kTerms], over[kTerms];
#pragma GCC unroll 6
    for (int p = 0; p < kTerms; ++p) {
#pragma GCC unroll 6
      for (int q = p; q < kTerms; ++q) a[p][q] = w[kX[p] + kX[q]][kY[p] + kY[q]];
      b[p] = z[kX[p]][kY[p]];
      whole[p] = a[p][p] * every(least_determined);
    }
#pragma GCC unroll 6
    for (int k = 0; k < kTerms; ++k) {
      // A term left out has no influence on the later ones, and no factor.
      over[k] = a[k][k] > whole[k] ? every(1.0) / a[k][k] : Pack{};
#pragma GCC unroll 6
      for (int p = k + 1; p < kTerms; ++p) {
        const Pack share = a[k][p] * over[k];
#pragma GCC unroll 6
        for (int q = p; q < kTerms; ++q) a[p][q] -= share * a[k][q];
        b[p] -= share * b[k];
      }
    }
    Pack x[kTerms];
#pragma GCC unroll 6
    for (int k = kTerms - 1; k >= 0; --k) {
      Pack rest = b[k];
#pragma GCC unroll 6
      for (int q = k + 1; q < kTerms; ++q) rest -= a[k][q] * x[q];
      x[k] = rest * over[k];
    }
    store(out + i, narrowed(w[0][0] > least_weight ? x[0] : none));
  }
}
