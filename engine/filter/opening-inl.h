// The kernels of opening.cpp; see each_cpu-inl.h.

// Heights to be eroded: `sign` times the heights, infinite where there is no sample.
inline void readyRow(float* z, float sign, int n) noexcept {
  for (int i = 0; i < n; ++i) z[i] = z[i] == z[i] ? sign * z[i] : __builtin_inff();
}

// Of what was eroded twice, turned over before the second time, the heights. A sample that the ball touches keeps its own: the sum of
// depth and height was rounded once and the depth is taken away again.
inline void settleRow(const double* low, const float* z, double deepest, float sign, float* out,
                      int n) noexcept {
  for (int i = 0; i < n; ++i) {
    const auto sample = static_cast<double>(z[i]);
    const double height = -low[i], rounding = 0x1p-51 * ((sample < 0.0 ? -sample : sample) + deepest);
    const float narrow = static_cast<float>(height);
    out[i] = sign * (0.0F + (height >= sample - rounding ? z[i] : narrow));
  }
}
