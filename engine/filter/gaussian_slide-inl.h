// Of the kernels of gaussian_plane.cpp and gaussian_regression.cpp; see each_cpu-inl.h. Products and sums are rounded each by itself,
// in the order of the taps, so that every level has the same bits.

// out[i] = sum over t of weights[t] * in[i + t * step], i in 0 .. n rounded up to kPack; in may be read as far.
inline void slide(const double* in, std::ptrdiff_t step, const double* weights, int taps, double* out,
                  int n) noexcept {
  constexpr int kTogether = FETTLE_LEVEL == 2 ? 4 : 8;
  constexpr int kColumns = kTogether * kPack;
  int i = 0;
  for (; i + kColumns <= n; i += kColumns) {
    Pack sum[kTogether] = {};
    const double* at = in + i;
    for (int t = 0; t < taps; ++t, at += step) {
      const Pack w = every(weights[t]);
#pragma GCC unroll 16
      for (int k = 0; k < kTogether; ++k) sum[k] += w * load<Pack>(at + kPack * k);
    }
#pragma GCC unroll 16
    for (int k = 0; k < kTogether; ++k) store(out + i + kPack * k, sum[k]);
  }
  for (; i < n; i += kPack) {
    Pack sum = {};
    const double* at = in + i;
    for (int t = 0; t < taps; ++t, at += step) sum += every(weights[t]) * load<Pack>(at);
    store(out + i, sum);
  }
}

// Samples between nodes: out[n * step + p] = sum over t of in[n + t] * weights[t * lane + p], p in 0 .. step; lane is step
// rounded up to kPack, and so much of out may be written.
inline void spreadOut(const double* in, int step, const double* weights, int taps, double* out,
                      int count) noexcept {
  const int lane = (step + 7) / 8 * 8;
  for (int n = 0; n < count; ++n)
    for (int p = 0; p < step; p += kPack) {
      Pack sum = {};
      for (int t = 0; t < taps; ++t)
        sum += every(in[n + t]) * load<Pack>(weights + static_cast<std::ptrdiff_t>(t) * lane + p);
      store(out + static_cast<std::ptrdiff_t>(n) * step + p, sum);
    }
}
