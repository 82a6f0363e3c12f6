// The kernels of ball_near.cpp; see each_cpu-inl.h.

// Single registers: compilers take comparisons of wider vectors apart to single numbers.
#if !defined(FETTLE_CPU_LEVELS)
using Fine = double;
using Coarse = float;
FETTLE_INLINE Coarse lesserOfTwo(Coarse a, Coarse b) noexcept {
  return a < b ? a : b;
}
FETTLE_INLINE Fine lesserOfTwo(Fine a, Fine b) noexcept {
  return a < b ? a : b;
}
FETTLE_INLINE Fine everywhere(double x) noexcept {
  return x;
}
FETTLE_INLINE Fine plus(Fine a, Fine b) noexcept {
  return a + b;
}
FETTLE_INLINE Fine partOf(Coarse z, int) noexcept {
  return static_cast<double>(z);
}
#elif FETTLE_LEVEL == 2
using Fine = __m512d;
using Coarse = __m512;
FETTLE_INLINE Coarse lesserOfTwo(const Coarse& a, const Coarse& b) noexcept {
  return _mm512_min_ps(a, b);
}
FETTLE_INLINE Fine lesserOfTwo(const Fine& a, const Fine& b) noexcept {
  return _mm512_min_pd(a, b);
}
FETTLE_INLINE Fine everywhere(double x) noexcept {
  return _mm512_set1_pd(x);
}
FETTLE_INLINE Fine plus(const Fine& a, const Fine& b) noexcept {
  return _mm512_add_pd(a, b);
}
FETTLE_INLINE Fine partOf(const Coarse& z, int half) noexcept {
  return _mm512_cvtps_pd(half == 0 ? _mm512_castps512_ps256(z) : _mm512_extractf32x8_ps(z, 1));
}
#elif FETTLE_LEVEL == 1
using Fine = __m256d;
using Coarse = __m256;
FETTLE_INLINE Coarse lesserOfTwo(const Coarse& a, const Coarse& b) noexcept {
  return _mm256_min_ps(a, b);
}
FETTLE_INLINE Fine lesserOfTwo(const Fine& a, const Fine& b) noexcept {
  return _mm256_min_pd(a, b);
}
FETTLE_INLINE Fine everywhere(double x) noexcept {
  return _mm256_set1_pd(x);
}
FETTLE_INLINE Fine plus(const Fine& a, const Fine& b) noexcept {
  return _mm256_add_pd(a, b);
}
FETTLE_INLINE Fine partOf(const Coarse& z, int half) noexcept {
  return _mm256_cvtps_pd(half == 0 ? _mm256_castps256_ps128(z) : _mm256_extractf128_ps(z, 1));
}
#else
using Fine = __m128d;
using Coarse = __m128;
FETTLE_INLINE Coarse lesserOfTwo(const Coarse& a, const Coarse& b) noexcept {
  return _mm_min_ps(a, b);
}
FETTLE_INLINE Fine lesserOfTwo(const Fine& a, const Fine& b) noexcept {
  return _mm_min_pd(a, b);
}
FETTLE_INLINE Fine everywhere(double x) noexcept {
  return _mm_set1_pd(x);
}
FETTLE_INLINE Fine plus(const Fine& a, const Fine& b) noexcept {
  return _mm_add_pd(a, b);
}
FETTLE_INLINE Fine partOf(const Coarse& z, int half) noexcept {
  return _mm_cvtps_pd(half == 0 ? z : _mm_movehl_ps(z, z));
}
#endif

template <class T>
struct NearLane {
  using Type = Fine;
};
template <>
struct NearLane<float> {
  using Type = Coarse;
};
FETTLE_INLINE Fine partOf(const Fine& z, int) noexcept {
  return z;
}

// out[i] = the lesser of a[i] and b[i], i in 0 .. n rounded up to 16.
template <class T>
void lesserRow(const T* a, const T* b, T* out, int n) noexcept {
  using Lane = typename NearLane<T>::Type;
  constexpr int kLane = sizeof(Lane) / sizeof(T);
  for (int i = 0; i < n; i += kLane) store(out + i, lesserOfTwo(load<Lane>(a + i), load<Lane>(b + i)));
}

// out[i] = least over `count` depths of the depth plus the least of what lies equally far away: `pairs` of offsets from rows + i,
// those of the k-th depth end before ends[k]. i in 0 .. n rounded up to 32.
template <class T>
void leastOfNear(const T* rows, const std::int32_t* pairs, const std::int32_t* ends, const double* depths,
                 int count, double* out, int n) noexcept {
  using Lane = typename NearLane<T>::Type;
  constexpr int kLane = sizeof(Lane) / sizeof(T), kFine = sizeof(Fine) / sizeof(double),
                kParts = kLane / kFine;
  constexpr int kWide = FETTLE_LEVEL == 2 ? 2 : kParts == 2 ? 2 : 4;
  for (int i = 0; i < n; i += kWide * kLane) {
    Fine low[kWide][kParts];
#pragma GCC unroll 4
    for (int k = 0; k < kWide; ++k)
#pragma GCC unroll 2
      for (int p = 0; p < kParts; ++p) low[k][p] = everywhere(__builtin_inf());
    const T* const from = rows + i;
    const std::int32_t* at = pairs;
    for (int d = 0; d < count; ++d) {
      Lane z[kWide];
#pragma GCC unroll 4
      for (int k = 0; k < kWide; ++k)
        z[k] = lesserOfTwo(load<Lane>(from + at[0] + k * kLane), load<Lane>(from + at[1] + k * kLane));
      for (at += 2; at != pairs + ends[d]; at += 2) {
#pragma GCC unroll 4
        for (int k = 0; k < kWide; ++k)
          z[k] = lesserOfTwo(
              lesserOfTwo(load<Lane>(from + at[0] + k * kLane), load<Lane>(from + at[1] + k * kLane)), z[k]);
      }
      const Fine depth = everywhere(depths[d]);
#pragma GCC unroll 4
      for (int k = 0; k < kWide; ++k)
#pragma GCC unroll 2
        for (int p = 0; p < kParts; ++p) low[k][p] = lesserOfTwo(plus(partOf(z[k], p), depth), low[k][p]);
    }
#pragma GCC unroll 4
    for (int k = 0; k < kWide; ++k)
#pragma GCC unroll 2
      for (int p = 0; p < kParts; ++p) store(out + i + k * kLane + p * kFine, low[k][p]);
  }
}
