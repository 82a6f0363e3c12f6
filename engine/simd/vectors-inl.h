// Vectors that the compiler cuts to what the processor has: 16 floats are one register with AVX-512, two with
// AVX, four with SSE. Included by each_cpu-inl.h for each level; no guard for that reason, and no includes.

constexpr int kLanes = 16;

using Floats = float __attribute__((vector_size(64)));
using Ints = int __attribute__((vector_size(64)));
using HalfFloats = float __attribute__((vector_size(32)));
using Doubles = double __attribute__((vector_size(64)));  // 8
using Longs = long long __attribute__((vector_size(64)));

// One register: of doubles, of half as many floats, and of as many floats or integers as it holds. What a loop carries from one round to
// the next is of these: GCC 12 keeps wider vectors in memory there, and moves them word by word.
constexpr int kPack = FETTLE_LEVEL == 2 ? 8 : FETTLE_LEVEL == 1 ? 4 : 2;
constexpr int kFloatPack = 2 * kPack;
using Pack = double __attribute__((vector_size(8 * kPack)));
using HalfPack = float __attribute__((vector_size(4 * kPack)));
using FloatPack = float __attribute__((vector_size(8 * kPack)));
using IntPack = int __attribute__((vector_size(8 * kPack)));

template <class Vector, class Element>
FETTLE_INLINE Vector load(const Element* from) noexcept {
  Vector v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

template <class Vector, class Element>
FETTLE_INLINE void store(Element* to, const Vector& v) noexcept {
  std::memcpy(to, &v, sizeof v);
}

// To 64 bytes at a multiple of 64, past the caches where the processor can; see pastCaches().
FETTLE_INLINE void storePast(float* to, const Floats& v) noexcept {
#if FETTLE_LEVEL == 2
  _mm512_stream_ps(to, v);
#elif FETTLE_LEVEL == 1
  __m256 half[2];
  std::memcpy(half, &v, sizeof v);
  _mm256_stream_ps(to, half[0]);
  _mm256_stream_ps(to + 8, half[1]);
#else
  std::memcpy(to, &v, sizeof v);
#endif
}

// After storePast and before another thread is notified of what was stored.
FETTLE_INLINE void pastCaches() noexcept {
#if FETTLE_LEVEL != 0
  _mm_sfence();
#endif
}

// The element in every place. Not Vector{} + x: 0 + x differs from x where x is -0, so the compiler would
// have to add, and to spread the sum with the ports that multiply.
FETTLE_INLINE Doubles spread(double x) noexcept {
#if FETTLE_LEVEL == 2
  return _mm512_set1_pd(x);
#else
  return Doubles{x, x, x, x, x, x, x, x};
#endif
}

FETTLE_INLINE Pack every(double x) noexcept {
#if FETTLE_LEVEL == 2
  return _mm512_set1_pd(x);
#elif FETTLE_LEVEL == 1
  return _mm256_set1_pd(x);
#else
  return Pack{x, x};
#endif
}

template <class Vector>
FETTLE_INLINE Vector lesser(const Vector& a, const Vector& b) noexcept {
  return a < b ? a : b;
}

template <class Vector>
FETTLE_INLINE Vector greater(const Vector& a, const Vector& b) noexcept {
  return a > b ? a : b;
}

// Register by register, the expressions above with instructions of their own, NaNs and zeros of both signs included: left to itself the
// compiler compares and chooses, and takes a comparison of wider vectors apart to single numbers.
#if defined(FETTLE_CPU_LEVELS) && FETTLE_LEVEL < 2
#if FETTLE_LEVEL == 1
FETTLE_INLINE FloatPack lesser(const FloatPack& a, const FloatPack& b) noexcept {
  return _mm256_min_ps(a, b);
}
FETTLE_INLINE FloatPack greater(const FloatPack& a, const FloatPack& b) noexcept {
  return _mm256_max_ps(a, b);
}
FETTLE_INLINE Pack lesser(const Pack& a, const Pack& b) noexcept {
  return _mm256_min_pd(a, b);
}
FETTLE_INLINE Pack greater(const Pack& a, const Pack& b) noexcept {
  return _mm256_max_pd(a, b);
}
#else
FETTLE_INLINE FloatPack lesser(const FloatPack& a, const FloatPack& b) noexcept {
  return _mm_min_ps(a, b);
}
FETTLE_INLINE FloatPack greater(const FloatPack& a, const FloatPack& b) noexcept {
  return _mm_max_ps(a, b);
}
FETTLE_INLINE Pack lesser(const Pack& a, const Pack& b) noexcept {
  return _mm_min_pd(a, b);
}
FETTLE_INLINE Pack greater(const Pack& a, const Pack& b) noexcept {
  return _mm_max_pd(a, b);
}
#endif
FETTLE_INLINE FloatPack packOf(const Floats& v, std::size_t at) noexcept {
  FloatPack part;
  std::memcpy(&part, reinterpret_cast<const char*>(&v) + at, sizeof part);
  return part;
}
FETTLE_INLINE Floats lesser(const Floats& a, const Floats& b) noexcept {
  Floats all;
  for (std::size_t at = 0; at < sizeof all; at += sizeof(FloatPack))
    store(reinterpret_cast<char*>(&all) + at, lesser(packOf(a, at), packOf(b, at)));
  return all;
}
FETTLE_INLINE Floats greater(const Floats& a, const Floats& b) noexcept {
  Floats all;
  for (std::size_t at = 0; at < sizeof all; at += sizeof(FloatPack))
    store(reinterpret_cast<char*>(&all) + at, greater(packOf(a, at), packOf(b, at)));
  return all;
}
#endif

FETTLE_INLINE Doubles widened(const HalfFloats& v) noexcept {
#if FETTLE_LEVEL == 2
  return _mm512_cvtps_pd(v);
#elif FETTLE_LEVEL == 1
  const __m256d low = _mm256_cvtps_pd(_mm256_castps256_ps128(v));
  const __m256d high = _mm256_cvtps_pd(_mm256_extractf128_ps(v, 1));
  Doubles wide;
  std::memcpy(&wide, &low, sizeof low);
  std::memcpy(reinterpret_cast<char*>(&wide) + sizeof low, &high, sizeof high);
  return wide;
#else
  return __builtin_convertvector(v, Doubles);
#endif
}

FETTLE_INLINE HalfFloats narrowed(const Doubles& v) noexcept {
#if FETTLE_LEVEL == 2
  return _mm512_cvtpd_ps(v);
#else
  return __builtin_convertvector(v, HalfFloats);
#endif
}

// Half 0 or 1 of 16 floats.
FETTLE_INLINE HalfFloats halfOf(const Floats& v, int half) noexcept {
#if FETTLE_LEVEL == 2
  // Left to itself the compiler sends the vector through memory.
  return half == 0 ? _mm512_castps512_ps256(v) : _mm512_extractf32x8_ps(v, 1);
#endif
  HalfFloats h;
  std::memcpy(&h, reinterpret_cast<const char*>(&v) + half * sizeof h, sizeof h);
  return h;
}

// a * b + c, rounded once. Processors without the instruction take the C library's, which is many times
// slower.
FETTLE_INLINE Doubles fused(const Doubles& a, const Doubles& b, const Doubles& c) noexcept {
#if FETTLE_LEVEL == 2
  return _mm512_fmadd_pd(a, b, c);
#elif FETTLE_LEVEL == 1
  Doubles sum;
  for (std::size_t h = 0; h < 2; ++h) {
    __m256d x, y, z;
    std::memcpy(&x, reinterpret_cast<const char*>(&a) + h * sizeof x, sizeof x);
    std::memcpy(&y, reinterpret_cast<const char*>(&b) + h * sizeof y, sizeof y);
    std::memcpy(&z, reinterpret_cast<const char*>(&c) + h * sizeof z, sizeof z);
    z = _mm256_fmadd_pd(x, y, z);
    std::memcpy(reinterpret_cast<char*>(&sum) + h * sizeof z, &z, sizeof z);
  }
  return sum;
#else
  Doubles sum;
  for (int l = 0; l < 8; ++l) sum[l] = __builtin_fma(a[l], b[l], c[l]);
  return sum;
#endif
}

#if FETTLE_LEVEL < 2
// Left to itself the compiler converts one half after the other.
FETTLE_INLINE Pack widened(const HalfPack& v) noexcept {
#if FETTLE_LEVEL == 1
  return _mm256_cvtps_pd(v);
#else
  return __builtin_convertvector(v, Pack);
#endif
}
FETTLE_INLINE HalfPack narrowed(const Pack& v) noexcept {
#if FETTLE_LEVEL == 1
  return _mm256_cvtpd_ps(v);
#else
  return __builtin_convertvector(v, HalfPack);
#endif
}
FETTLE_INLINE HalfPack halfOf(const FloatPack& v, int half) noexcept {
  HalfPack h;
  std::memcpy(&h, reinterpret_cast<const char*>(&v) + half * sizeof h, sizeof h);
  return h;
}
FETTLE_INLINE Pack fused(const Pack& a, const Pack& b, const Pack& c) noexcept {
#if FETTLE_LEVEL == 1
  return _mm256_fmadd_pd(a, b, c);
#else
  return Pack{__builtin_fma(a[0], b[0], c[0]), __builtin_fma(a[1], b[1], c[1])};
#endif
}
#endif
