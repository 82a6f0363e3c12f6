// Vectors of the registers that a processor has. Included by each_cpu-inl.h for each level; no guard for that reason, and no includes.

// One register: of doubles, of half as many floats, and of as many floats or integers as it holds. Wider vectors GCC 12 keeps in memory
// where a loop carries them from one round to the next, moves them word by word, and takes their comparisons apart to single numbers.
constexpr int kPack = FETTLE_LEVEL == 2 ? 8 : FETTLE_LEVEL == 1 ? 4 : 2;
constexpr int kFloatPack = 2 * kPack;
using Pack = double __attribute__((vector_size(8 * kPack)));
using HalfPack = float __attribute__((vector_size(4 * kPack)));
using FloatPack = float __attribute__((vector_size(8 * kPack)));
using IntPack = int __attribute__((vector_size(8 * kPack)));

// Sixteen lanes at every level, in one register, two or four: for kernels whose results follow from which lanes are side by side.
constexpr int kLanes = 16;
using Floats = float __attribute__((vector_size(64)));
using Ints = int __attribute__((vector_size(64)));

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

// To a multiple of the register's size, past the caches where the processor can; see pastCaches().
FETTLE_INLINE void storePast(float* to, const FloatPack& v) noexcept {
#if FETTLE_LEVEL == 2
  _mm512_stream_ps(to, v);
#elif FETTLE_LEVEL == 1
  _mm256_stream_ps(to, v);
#else
  store(to, v);
#endif
}

// After storePast and before another thread is notified of what was stored.
FETTLE_INLINE void pastCaches() noexcept {
#if FETTLE_LEVEL != 0
  _mm_sfence();
#endif
}

// The element in every place. Not Pack{} + x: 0 + x differs from x where x is -0, so the compiler would
// have to add, and to spread the sum with the ports that multiply.
FETTLE_INLINE Pack every(double x) noexcept {
#if FETTLE_LEVEL == 2
  return _mm512_set1_pd(x);
#elif FETTLE_LEVEL == 1
  return _mm256_set1_pd(x);
#else
  return Pack{x, x};
#endif
}

// NaNs and zeros of both signs as the expressions have them.
template <class Vector>
FETTLE_INLINE Vector lesser(const Vector& a, const Vector& b) noexcept {
  return a < b ? a : b;
}

template <class Vector>
FETTLE_INLINE Vector greater(const Vector& a, const Vector& b) noexcept {
  return a > b ? a : b;
}

// With instructions of their own: left to itself the compiler compares and chooses.
#if defined(FETTLE_CPU_LEVELS)
#if FETTLE_LEVEL == 2
FETTLE_INLINE FloatPack lesser(const FloatPack& a, const FloatPack& b) noexcept {
  return _mm512_min_ps(a, b);
}
FETTLE_INLINE FloatPack greater(const FloatPack& a, const FloatPack& b) noexcept {
  return _mm512_max_ps(a, b);
}
FETTLE_INLINE Pack lesser(const Pack& a, const Pack& b) noexcept {
  return _mm512_min_pd(a, b);
}
FETTLE_INLINE Pack greater(const Pack& a, const Pack& b) noexcept {
  return _mm512_max_pd(a, b);
}
#elif FETTLE_LEVEL == 1
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
#endif

#if FETTLE_LEVEL < 2
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

// Left to itself the compiler converts one half after the other, or single numbers.
FETTLE_INLINE Pack widened(const HalfPack& v) noexcept {
#if FETTLE_LEVEL == 2
  return _mm512_cvtps_pd(v);
#elif FETTLE_LEVEL == 1
  return _mm256_cvtps_pd(v);
#else
  return __builtin_convertvector(v, Pack);
#endif
}

FETTLE_INLINE HalfPack narrowed(const Pack& v) noexcept {
#if FETTLE_LEVEL == 2
  return _mm512_cvtpd_ps(v);
#elif FETTLE_LEVEL == 1
  return _mm256_cvtpd_ps(v);
#else
  return __builtin_convertvector(v, HalfPack);
#endif
}

// Half 0 or 1 as doubles. Left to itself the compiler sends the vector through memory.
FETTLE_INLINE Pack widenedHalf(const FloatPack& v, int half) noexcept {
#if FETTLE_LEVEL == 2
  return _mm512_cvtps_pd(half == 0 ? _mm512_castps512_ps256(v) : _mm512_extractf32x8_ps(v, 1));
#elif FETTLE_LEVEL == 1
  return _mm256_cvtps_pd(half == 0 ? _mm256_castps256_ps128(v) : _mm256_extractf128_ps(v, 1));
#elif defined(FETTLE_CPU_LEVELS)
  return _mm_cvtps_pd(half == 0 ? v : _mm_movehl_ps(v, v));
#else
  return half == 0 ? Pack{v[0], v[1]} : Pack{v[2], v[3]};
#endif
}

// a * b + c, rounded once. Processors without the instruction take the C library's, which is many times
// slower.
FETTLE_INLINE Pack fused(const Pack& a, const Pack& b, const Pack& c) noexcept {
#if FETTLE_LEVEL == 2
  return _mm512_fmadd_pd(a, b, c);
#elif FETTLE_LEVEL == 1
  return _mm256_fmadd_pd(a, b, c);
#else
  return Pack{__builtin_fma(a[0], b[0], c[0]), __builtin_fma(a[1], b[1], c[1])};
#endif
}
