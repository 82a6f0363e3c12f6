// The kernels of gaussian_strip.cpp; see each_cpu-inl.h. Products and sums are rounded each by itself, in the order of the
// taps, as in gaussian_plane-inl.h.

// Heights of `n` samples, a multiple of 8, as doubles; holes are 0. Returns the number that are none.
inline int widen(const float* heights, double* value, int n) noexcept {
  decltype(Pack{} == Pack{}) there = {};
  for (int i = 0; i < n; i += kPack) {
    const Pack z = widened(load<HalfPack>(heights + i));
    // All bits of a true comparison are set: -1.
    there -= z == z;
    store(value + i, z == z ? z : Pack{});
  }
  long long count = 0;
  for (int k = 0; k < kPack; ++k) count += there[k];
  return static_cast<int>(count);
}

#include "engine/filter/gaussian_weigh-inl.h"

// out[i] = sum over t of weights[t] * in[i + t], i in 0 .. 64.
inline void alongStrip(const double* in, const double* weights, int taps, double* out) noexcept {
  constexpr int kTogether = 8;
  for (int i = 0; i < 64; i += kPack * kTogether) {
    Pack sum[kTogether] = {};
    for (int t = 0; t < taps; ++t) {
      const Pack w = every(weights[t]);
#pragma GCC unroll 8
      for (int k = 0; k < kTogether; ++k) sum[k] += w * load<Pack>(in + i + t + kPack * k);
    }
#pragma GCC unroll 8
    for (int k = 0; k < kTogether; ++k) store(out + i + kPack * k, sum[k]);
  }
}

// Four rows of 64 sums: to[64 * j + i] = sum over t of weights[t] * rows[j + t][i]. taps at least 4.
inline void downStrip(const double* const* rows, const double* weights, int taps, double* to) noexcept {
  constexpr int kRows = 4;
  constexpr int kTogether = FETTLE_LEVEL == 2 ? 4 : 2;
  for (int i = 0; i < 64; i += kPack * kTogether) {
    Pack sum[kRows][kTogether] = {};
    // The sums of rows [from, to) that row t of those read is in, constants after unrolling.
    const auto take = [&](int t, int from, int end) __attribute__((always_inline)) {
      Pack z[kTogether];
#pragma GCC unroll 4
      for (int k = 0; k < kTogether; ++k) z[k] = load<Pack>(rows[t] + i + kPack * k);
#pragma GCC unroll 4
      for (int j = 0; j < kRows; ++j) {
        if (j < from || j >= end) continue;
        const Pack w = every(weights[t - j]);
#pragma GCC unroll 4
        for (int k = 0; k < kTogether; ++k) sum[j][k] += w * z[k];
      }
    };
    for (int t = 0; t < kRows - 1; ++t) take(t, 0, t + 1);
    for (int t = kRows - 1; t < taps; ++t) take(t, 0, kRows);
    for (int t = 1; t < kRows; ++t) take(taps + t - 1, t, kRows);
#pragma GCC unroll 4
    for (int j = 0; j < kRows; ++j)
#pragma GCC unroll 4
      for (int k = 0; k < kTogether; ++k) store(to + 64 * j + i + kPack * k, sum[j][k]);
  }
}

// As divide() in gaussian_plane-inl.h.
inline void divideStrip(const double* value, const double* weight, float* out, int n) noexcept {
  for (int i = 0; i < n; i += kPack) store(out + i, narrowed(load<Pack>(value + i) / load<Pack>(weight + i)));
}
