// Of the kernels of gaussian_plane.cpp and gaussian_strip.cpp; see each_cpu-inl.h.

// A row of heights as weights and weighted heights; `middle` null: every sample weighs 1.
inline void weigh(const float* heights, const float* middle, double limit, double* value, double* weight,
                  int n) noexcept {
  const Doubles inverse = spread(1.0 / limit);
  for (int i = 0; i < n; i += 8) {
    const Doubles z = widened(load<HalfFloats>(heights + i));
    Doubles w = spread(1.0);
    if (middle != nullptr) {
      const Doubles r = (z - widened(load<HalfFloats>(middle + i))) * inverse;
      const Doubles rest = spread(1.0) - r * r;
      w = rest > 0.0 ? rest * rest : Doubles{};
    }
    // A hole compares false with itself.
    store(value + i, z == z ? z * w : Doubles{});
    store(weight + i, z == z ? w : Doubles{});
  }
}
