// The kernels of disk_erosion.cpp; see each_cpu-inl.h.

// out[i] = the lesser of a[i] and b[i], i in 0 .. n rounded up to kFloatPack.
inline void lesserOf(const float* a, const float* b, float* out, int n) noexcept {
  for (int i = 0; i < n; i += kFloatPack)
    store(out + i, lesser(load<FloatPack>(a + i), load<FloatPack>(b + i)));
}

// Lowers one[i] and other[i] to the lesser of a[i] and b[i].
inline void lowerTwo(const float* a, const float* b, float* one, float* other, int n) noexcept {
  for (int i = 0; i < n; i += kFloatPack) {
    const FloatPack low = lesser(load<FloatPack>(a + i), load<FloatPack>(b + i));
    store(one + i, lesser(load<FloatPack>(one + i), low));
    store(other + i, lesser(load<FloatPack>(other + i), low));
  }
}

inline void lowerOne(const float* a, const float* b, float* one, int n) noexcept {
  for (int i = 0; i < n; i += kFloatPack) {
    const FloatPack low = lesser(load<FloatPack>(a + i), load<FloatPack>(b + i));
    store(one + i, lesser(load<FloatPack>(one + i), low));
  }
}

// Four rows of 64 results from `column` on: of each the least of `count` rows' chords, the lesser of what lies at two places of its
// row; those of the j-th begin at rows[j]. Together, because a row lies nearer than the second time. count at least 1.
inline void leastOfChords(const float* const* rows, std::ptrdiff_t column, const std::ptrdiff_t* one,
                          const std::ptrdiff_t* other, int count, float* out) noexcept {
  constexpr int kRows = 4, kWide = FETTLE_LEVEL == 2 ? 4 : 2;
  for (int c = 0; c < 64; c += kWide * kFloatPack) {
    FloatPack low[kRows][kWide];
#pragma GCC unroll 4
    for (int j = 0; j < kRows; ++j)
#pragma GCC unroll 4
      for (int k = 0; k < kWide; ++k) low[j][k] = FloatPack{} + __builtin_inff();
    const auto take = [&](int i, int j) __attribute__((always_inline)) {
      const float* const a = rows[i] + column + c + one[i - j];
      const float* const b = rows[i] + column + c + other[i - j];
#pragma GCC unroll 4
      for (int k = 0; k < kWide; ++k) {
        const FloatPack chord =
            lesser(load<FloatPack>(a + k * kFloatPack), load<FloatPack>(b + k * kFloatPack));
        low[j][k] = lesser(low[j][k], chord);
      }
    };
#pragma GCC unroll 4
    for (int j = 0; j < kRows; ++j) {
      for (int i = j; i < kRows - 1 && i < j + count; ++i) take(i, j);
      for (int i = count > kRows - 1 ? count : kRows - 1; i < j + count; ++i) take(i, j);
    }
    for (int i = kRows - 1; i < count; ++i) {
#pragma GCC unroll 4
      for (int j = 0; j < kRows; ++j) take(i, j);
    }
#pragma GCC unroll 4
    for (int j = 0; j < kRows; ++j)
#pragma GCC unroll 4
      for (int k = 0; k < kWide; ++k) store(out + j * 64 + c + k * kFloatPack, low[j][k]);
  }
}
