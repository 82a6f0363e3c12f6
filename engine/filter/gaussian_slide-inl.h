// Of the kernels of gaussian_plane.cpp and gaussian_regression.cpp; see each_cpu-inl.h. Products and sums are rounded each by itself,
// in the order of the taps, so that every level has the same bits.

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
