// The kernels of gaussian_plane.cpp; see each_cpu-inl.h. Products and sums are rounded each by itself, in the order of the
// taps, so that every level has the same bits.

// out[i] = sum over t of weights[t] * in[i + t * step], i in 0 .. n rounded up to 8; in may be read as far.
inline void slide(const double* in, std::ptrdiff_t step, const double* weights, int taps, double* out,
                  int n) noexcept {
  int i = 0;
  for (; i + 32 <= n; i += 32) {
    Doubles sum[4] = {};
    const double* at = in + i;
    for (int t = 0; t < taps; ++t, at += step) {
      const Doubles w = spread(weights[t]);
#pragma GCC unroll 4
      for (int k = 0; k < 4; ++k) sum[k] += w * load<Doubles>(at + 8 * k);
    }
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) store(out + i + 8 * k, sum[k]);
  }
  for (; i < n; i += 8) {
    Doubles sum = {};
    const double* at = in + i;
    for (int t = 0; t < taps; ++t, at += step) sum += spread(weights[t]) * load<Doubles>(at);
    store(out + i, sum);
  }
}

// to[i] += weight * from[i], i in 0 .. n rounded up to 8.
inline void accumulate(const double* from, double weight, double* to, int n) noexcept {
  const Doubles w = spread(weight);
  for (int i = 0; i < n; i += 8) store(to + i, load<Doubles>(to + i) + w * load<Doubles>(from + i));
}

// Sums of in[n * step + t] * weights[t] for the nodes n in 0 .. count; taps a multiple of 8.
inline void thin(const double* in, int step, const double* weights, int taps, double* out,
                 int count) noexcept {
  for (int n = 0; n < count; ++n) {
    const double* at = in + static_cast<std::ptrdiff_t>(n) * step;
    Doubles sum = {};
    for (int t = 0; t < taps; t += 8) sum += load<Doubles>(weights + t) * load<Doubles>(at + t);
    out[n] = ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]));
  }
}

// Samples between nodes: out[n * step + p] = sum over t of in[n + t] * weights[t * lane + p], p in 0 .. step; lane is step
// rounded up to 8, and so much of out may be written.
inline void spreadOut(const double* in, int step, const double* weights, int taps, double* out,
                      int count) noexcept {
  const int lane = (step + 7) / 8 * 8;
  for (int n = 0; n < count; ++n)
    for (int p = 0; p < step; p += 8) {
      Doubles sum = {};
      for (int t = 0; t < taps; ++t)
        sum += spread(in[n + t]) * load<Doubles>(weights + static_cast<std::ptrdiff_t>(t) * lane + p);
      store(out + static_cast<std::ptrdiff_t>(n) * step + p, sum);
    }
}

#include "engine/filter/gaussian_weigh-inl.h"

inline void divide(const double* value, const double* weight, float* out, int n) noexcept {
  for (int i = 0; i < n; i += 8)
    store(out + i, narrowed(load<Doubles>(value + i) / load<Doubles>(weight + i)));
}
