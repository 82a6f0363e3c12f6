// The kernels of erosion.cpp; see each_cpu-inl.h.

// line[i] = the lesser of line[i] and line[i + shift], i in 0 .. n rounded up to 16.
inline void lowerByShift(float* line, int shift, int n) noexcept {
  for (int i = 0; i < n; i += kLanes)
    store(line + i, lesser(load<Floats>(line + i), load<Floats>(line + i + shift)));
}

// out[i] = the lesser of a[i] and b[i], i in 0 .. n rounded up to 16.
inline void lesserOf(const float* a, const float* b, float* out, int n) noexcept {
  for (int i = 0; i < n; i += kLanes) store(out + i, lesser(load<Floats>(a + i), load<Floats>(b + i)));
}

// 64 columns: out[r] = least of rows first + r .. first + r + window - 1 of `in`, r in 0 .. out_rows; rows outside 0 .. rows
// have no sample. Blocks of `window` rows: each result is the least of the end of one and the beginning of the next
// (M. van Herk, A fast algorithm for local minimum and maximum filters, 1992; J. Gil, M. Werman, 1993). `ends`: 64 times the
// smaller of window and out_rows.
inline void leastDown(const float* in, std::ptrdiff_t stride, int rows, int first, int window, float* ends,
                      float* out, std::ptrdiff_t out_stride, int out_rows) noexcept {
  constexpr int kWide = 4;
  const Floats none = Floats{} + __builtin_inff();
  for (int begin = 0; begin < out_rows; begin += window) {
    const int end = out_rows - begin < window ? out_rows - begin : window;
    Floats low[kWide] = {none, none, none, none};
    for (int j = window - 1; j >= 0; --j) {
      const int r = first + begin + j;
      if (r >= 0 && r < rows) {
#pragma GCC unroll 4
        for (int k = 0; k < kWide; ++k) low[k] = lesser(low[k], load<Floats>(in + r * stride + k * kLanes));
      }
      if (j < end) {
#pragma GCC unroll 4
        for (int k = 0; k < kWide; ++k) store(ends + j * kWide * kLanes + k * kLanes, low[k]);
      }
    }
    for (Floats& each : low) each = none;
    for (int j = 0; j < end; ++j) {
      const int r = first + begin + window + j - 1;
      if (j > 0 && r >= 0 && r < rows) {
#pragma GCC unroll 4
        for (int k = 0; k < kWide; ++k) low[k] = lesser(low[k], load<Floats>(in + r * stride + k * kLanes));
      }
#pragma GCC unroll 4
      for (int k = 0; k < kWide; ++k)
        store(out + (begin + j) * out_stride + k * kLanes,
              lesser(low[k], load<Floats>(ends + j * kWide * kLanes + k * kLanes)));
    }
  }
}

// Least of 8 x 8 values.
inline double leastOfBlock(const double* from, std::ptrdiff_t stride) noexcept {
  Doubles low = load<Doubles>(from);
  for (int r = 1; r < 8; ++r) low = lesser(low, load<Doubles>(from + r * stride));
  double least = low[0];
  for (int k = 1; k < 8; ++k) least = low[k] < least ? low[k] : least;
  return least;
}

// Doubles of one register: compilers take comparisons of wider vectors apart to single numbers.
#if FETTLE_LEVEL == 2
using Lane = __m512d;
FETTLE_INLINE Lane laneOf(double x) noexcept {
  return _mm512_set1_pd(x);
}
FETTLE_INLINE Lane laneAt(const double* from) noexcept {
  return _mm512_loadu_pd(from);
}
FETTLE_INLINE void keep(double* to, const Lane& v) noexcept {
  _mm512_storeu_pd(to, v);
}
FETTLE_INLINE Lane lowered(const Lane& z, const Lane& depth, const Lane& low) noexcept {
  return _mm512_min_pd(_mm512_add_pd(z, depth), low);
}
#elif FETTLE_LEVEL == 1
using Lane = __m256d;
FETTLE_INLINE Lane laneOf(double x) noexcept {
  return _mm256_set1_pd(x);
}
FETTLE_INLINE Lane laneAt(const double* from) noexcept {
  return _mm256_loadu_pd(from);
}
FETTLE_INLINE void keep(double* to, const Lane& v) noexcept {
  _mm256_storeu_pd(to, v);
}
FETTLE_INLINE Lane lowered(const Lane& z, const Lane& depth, const Lane& low) noexcept {
  return _mm256_min_pd(_mm256_add_pd(z, depth), low);
}
#else
using Lane = double;
FETTLE_INLINE Lane laneOf(double x) noexcept {
  return x;
}
FETTLE_INLINE Lane laneAt(const double* from) noexcept {
  return *from;
}
FETTLE_INLINE void keep(double* to, const Lane& v) noexcept {
  *to = v;
}
FETTLE_INLINE Lane lowered(const Lane& z, const Lane& depth, const Lane& low) noexcept {
  return z + depth < low ? z + depth : low;
}
#endif

// Lowers 8 rows of 16 results, `low`, to the values of a block of 8 x 8 plus their depths. depths[7 + r - q]: those between
// row r of the results and row q of the block, from the distance of their first columns on; 7 before and 15 after it are read.
// Returns the largest result.
inline double lowerToBlock(const double* block, std::ptrdiff_t stride, const double* const* depths,
                           double* low) noexcept {
  constexpr int kLane = sizeof(Lane) / sizeof(double);
  // So many results at once that no sum waits for the one before: of two rows where a row is few registers.
  constexpr int kTogether = kLane == 1 ? 8 : kLane == 4 ? 4 : 2, kRows = kLane == 8 ? 2 : 1;
  for (int r = 0; r < 8; r += kRows)
    for (int c = 0; c < 16; c += kTogether * kLane) {
      Lane at[kRows][kTogether];
#pragma GCC unroll 8
      for (int k = 0; k < kRows * kTogether; ++k)
        at[k / kTogether][k % kTogether] = laneAt(low + 16 * (r + k / kTogether) + c + k % kTogether * kLane);
      for (int q = 0; q < 8; ++q) {
        const double* const from = block + q * stride;
        const double* const* const rows = depths + (7 + r - q);
#pragma GCC unroll 8
        for (int p = 0; p < 8; ++p) {
          const Lane z = laneOf(from[p]);
#pragma GCC unroll 8
          for (int k = 0; k < kRows * kTogether; ++k)
            at[k / kTogether][k % kTogether] =
                lowered(z, laneAt(rows[k / kTogether] + c + k % kTogether * kLane - p),
                        at[k / kTogether][k % kTogether]);
        }
      }
#pragma GCC unroll 8
      for (int k = 0; k < kRows * kTogether; ++k)
        keep(low + 16 * (r + k / kTogether) + c + k % kTogether * kLane, at[k / kTogether][k % kTogether]);
    }
  double most[8];
  for (int k = 0; k < 8; ++k) most[k] = low[k];
  for (int i = 8; i < 128; i += 8)
    for (int k = 0; k < 8; ++k) most[k] = low[i + k] > most[k] ? low[i + k] : most[k];
  for (int k = 1; k < 8; ++k) most[0] = most[k] > most[0] ? most[k] : most[0];
  return most[0];
}
