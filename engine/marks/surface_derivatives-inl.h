// The kernels of surface_derivatives.cpp; see kernel.h.

// out[c] = sum of weights[k] * in[c + k] for c in [0, n).
void slide(const float* __restrict in, const float* __restrict weights, int taps, int n,
           float* __restrict out) noexcept {
  for (int c = 0; c < n; ++c) out[c] = 0.0F;
  for (int k = 0; k < taps; ++k) {
    const float w = weights[k];
    for (int c = 0; c < n; ++c) out[c] += w * in[c + k];
  }
}

// out[c] = sum of weights[k] * in[k * stride + c].
void slideUp(const float* __restrict in, std::ptrdiff_t stride, const float* __restrict weights, int taps,
             int n, float* __restrict out) noexcept {
  for (int c = 0; c < n; ++c) out[c] = 0.0F;
  for (int k = 0; k < taps; ++k) {
    const float w = weights[k];
    const float* row = in + k * stride;
    for (int c = 0; c < n; ++c) out[c] += w * row[c];
  }
}
