// The kernel of spline_lines.cpp; see each_cpu-inl.h. Products and sums are rounded each by itself, so that every level has
// the same bits.

// 32 lines side by side, z[i * 32 + line], become what the filter takes from them. The lines have 3 samples at least.
inline void takeRough(double* z, int samples, double step, const double* to_height, const double* to_slope,
                      const double* over_variance) noexcept {
  constexpr int kWide = 4;
  constexpr int kLines = kWide * kPack;  // at once: what registers hold
  const Pack part = every(1.0 / step), whole = every(step);
  for (double* const all = z + 32; z < all; z += kLines) {
    Pack height[kWide], slope[kWide];
    for (int k = 0; k < kWide; ++k) {
      // The first two determine the line of the prediction.
      const Pack first = load<Pack>(z + kPack * k), second = load<Pack>(z + 32 + kPack * k);
      slope[k] = (second - first) * whole;
      height[k] = second + slope[k] * part;
    }
    for (int i = 2; i < samples; ++i) {
      const Pack a = every(to_height[i]), b = every(to_slope[i]), c = every(over_variance[i]);
#pragma GCC unroll 4
      for (int k = 0; k < kWide; ++k) {
        double* const at = z + 32 * static_cast<std::ptrdiff_t>(i) + kPack * k;
        const Pack off = load<Pack>(at) - height[k];
        store(at, off * c);
        slope[k] = slope[k] + b * off;
        height[k] = (height[k] + a * off) + slope[k] * part;
      }
    }
    // The adjoint of all that, from the last sample on.
    for (int k = 0; k < kWide; ++k) height[k] = slope[k] = Pack{};
    for (int i = samples - 1; i >= 2; --i) {
      const Pack a = every(to_height[i]), b = every(to_slope[i]);
#pragma GCC unroll 4
      for (int k = 0; k < kWide; ++k) {
        double* const at = z + 32 * static_cast<std::ptrdiff_t>(i) + kPack * k;
        slope[k] = slope[k] + height[k] * part;
        const Pack rough = (load<Pack>(at) - a * height[k]) - b * slope[k];
        store(at, rough);
        height[k] = height[k] + rough;
      }
    }
    for (int k = 0; k < kWide; ++k) {
      const Pack turned = (slope[k] + height[k] * part) * whole;
      store(z + kPack * k, turned);
      store(z + 32 + kPack * k, -(height[k] + turned));
    }
  }
}
