// Of the kernels of gaussian_plane.cpp; see each_cpu-inl.h.

// A row of heights as weights and weighted heights; `weights` null: every sample weighs 1.
inline void weigh(const float* heights, const float* weights, double* value, double* weight, int n) noexcept {
  for (int i = 0; i < n; i += kPack) {
    const Pack z = widened(load<HalfPack>(heights + i));
    const Pack w = weights != nullptr ? widened(load<HalfPack>(weights + i)) : every(1.0);
    // A hole compares false with itself.
    store(value + i, z == z ? z * w : Pack{});
    store(weight + i, z == z ? w : Pack{});
  }
}
