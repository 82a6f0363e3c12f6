// The kernels of erosion.cpp; see each_cpu-inl.h.

// line[i] = the lesser of line[i] and line[i + shift], i in 0 .. n rounded up to kFloatPack.
inline void lowerByShift(float* line, int shift, int n) noexcept {
  for (int i = 0; i < n; i += kFloatPack)
    store(line + i, lesser(load<FloatPack>(line + i), load<FloatPack>(line + i + shift)));
}

// out[i] = the lesser of a[i] and b[i], i in 0 .. n rounded up to kFloatPack.
inline void lesserOf(const float* a, const float* b, float* out, int n) noexcept {
  for (int i = 0; i < n; i += kFloatPack)
    store(out + i, lesser(load<FloatPack>(a + i), load<FloatPack>(b + i)));
}

// 64 columns: out[r] = least of rows first + r .. first + r + window - 1 of `in`, r in 0 .. out_rows; rows outside 0 .. rows
// have no sample. Blocks of `window` rows: each result is the least of the end of one and the beginning of the next
// (M. van Herk, A fast algorithm for local minimum and maximum filters, 1992; J. Gil, M. Werman, 1993). `ends`: 64 times the
// smaller of window and out_rows.
inline void leastDown(const float* in, std::ptrdiff_t stride, int rows, int first, int window, float* ends,
                      float* out, std::ptrdiff_t out_stride, int out_rows) noexcept {
  constexpr int kWide = 64 / kFloatPack;
  const FloatPack none = FloatPack{} + __builtin_inff();
  for (int begin = 0; begin < out_rows; begin += window) {
    const int end = out_rows - begin < window ? out_rows - begin : window;
    FloatPack low[kWide];
    for (FloatPack& each : low) each = none;
    for (int j = window - 1; j >= 0; --j) {
      const int r = first + begin + j;
      if (r >= 0 && r < rows) {
#pragma GCC unroll 16
        for (int k = 0; k < kWide; ++k)
          low[k] = lesser(low[k], load<FloatPack>(in + r * stride + k * kFloatPack));
      }
      if (j < end) {
#pragma GCC unroll 16
        for (int k = 0; k < kWide; ++k) store(ends + j * kWide * kFloatPack + k * kFloatPack, low[k]);
      }
    }
    for (FloatPack& each : low) each = none;
    for (int j = 0; j < end; ++j) {
      const int r = first + begin + window + j - 1;
      if (j > 0 && r >= 0 && r < rows) {
#pragma GCC unroll 16
        for (int k = 0; k < kWide; ++k)
          low[k] = lesser(low[k], load<FloatPack>(in + r * stride + k * kFloatPack));
      }
#pragma GCC unroll 16
      for (int k = 0; k < kWide; ++k)
        store(out + (begin + j) * out_stride + k * kFloatPack,
              lesser(low[k], load<FloatPack>(ends + j * kWide * kFloatPack + k * kFloatPack)));
    }
  }
}
