// The kernels of gaussian_plane.cpp; see each_cpu-inl.h. Products and sums are rounded each by itself, in the order of the
// taps, so that every level has the same bits.

#include "engine/filter/gaussian_slide-inl.h"
#include "engine/filter/gaussian_weigh-inl.h"

// to[i] += weight * from[i], i in 0 .. n rounded up to kPack.
inline void accumulate(const double* from, double weight, double* to, int n) noexcept {
  const Pack w = every(weight);
  for (int i = 0; i < n; i += kPack) store(to + i, load<Pack>(to + i) + w * load<Pack>(from + i));
}

// Sums of in[n * step + t] * weights[t] for the nodes n in 0 .. count; taps a multiple of 8.
inline void thin(const double* in, int step, const double* weights, int taps, double* out,
                 int count) noexcept {
  for (int n = 0; n < count; ++n) {
    const double* at = in + static_cast<std::ptrdiff_t>(n) * step;
    Pack parts[8 / kPack] = {};
    for (int t = 0; t < taps; t += 8)
#pragma GCC unroll 4
      for (int k = 0; k < 8 / kPack; ++k)
        parts[k] += load<Pack>(weights + t + k * kPack) * load<Pack>(at + t + k * kPack);
    double sum[8];
    std::memcpy(sum, parts, sizeof sum);
    out[n] = ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]));
  }
}

inline void divide(const double* value, const double* weight, float* out, int n) noexcept {
  for (int i = 0; i < n; i += kPack) store(out + i, narrowed(load<Pack>(value + i) / load<Pack>(weight + i)));
}
