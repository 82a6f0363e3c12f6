// The kernels of filter_bounds.cpp; see each_cpu-inl.h. Eight chains at once, more than the latency of an instruction hides; in registers
// where there are 32 of them, with AVX-512: with AVX2 some are spilled, and the bound is too slow.

double productsAlone(int rounds) noexcept {
  Doubles v[8];
  for (int i = 0; i < 8; ++i) v[i] = spread(0.1 * i);
  const Doubles a = spread(0.5), b = spread(0.25);
  for (int k = 0; k < rounds; ++k)
#pragma GCC unroll 8
    for (int i = 0; i < 8; ++i) v[i] = fused(v[i], a, b);
  double sum = 0.0;
  for (const Doubles& each : v) sum += each[0];
  return sum;
}

double extremaAlone(int rounds) noexcept {
  Floats v[8];
  for (int i = 0; i < 8; ++i) v[i] = Floats{} + 0.1F * static_cast<float>(i);
  Floats low = Floats{} + 0.2F, high = Floats{} + 0.4F;
  for (int k = 0; k < rounds; k += 2)
#pragma GCC unroll 8
    for (int i = 0; i < 8; ++i)
#if FETTLE_LEVEL == 2
      v[i] =
          _mm512_max_ps(_mm512_min_ps(v[i], high), low);  // left to itself the compiler compares and chooses
#else
      v[i] = greater(lesser(v[i], high), low);
#endif
  double sum = 0.0;
  for (const Floats& each : v) sum += each[0];
  return sum;
}

// As many chains as registers hold beside what they need.
constexpr int kChains = FETTLE_LEVEL == 2 ? 8 : FETTLE_LEVEL == 1 ? 4 : 2;
// The nearest cache holds two of these.
constexpr int kPlaces = 64;

FETTLE_INLINE Floats lesserAlone(const Floats& a, const Floats& b) noexcept {
#if FETTLE_LEVEL == 2
  return _mm512_min_ps(a, b);
#else
  return lesser(a, b);
#endif
}

// `rows`: 2 * (kPlaces + kChains) * kLanes floats, at a multiple of 64 bytes: no chord begins farther from a cache line.
double chordsAlone(const float* rows, int rounds) noexcept {
  Floats low[kChains];
  for (int i = 0; i < kChains; ++i) low[i] = Floats{} + 1e30F;
  for (int k = 0; k < rounds; ++k) {
    const float* const one = rows + k % kPlaces * kLanes;
    const float* const other = one + (kPlaces + kChains) * kLanes;
#pragma GCC unroll 8
    for (int i = 0; i < kChains; ++i)
      low[i] =
          lesserAlone(lesserAlone(load<Floats>(one + i * kLanes), load<Floats>(other + i * kLanes)), low[i]);
  }
  double sum = 0.0;
  for (const Floats& each : low) sum += each[0];
  return sum;
}

// Register by register: compilers take comparisons of wider vectors apart to single numbers.
#if !defined(FETTLE_CPU_LEVELS)
using Sums = double;
FETTLE_INLINE Sums everySum(double x) noexcept {
  return x;
}
FETTLE_INLINE Sums loweredSum(Sums z, Sums depth, Sums low) noexcept {
  return z + depth < low ? z + depth : low;
}
#elif FETTLE_LEVEL == 2
using Sums = __m512d;
FETTLE_INLINE Sums everySum(double x) noexcept {
  return _mm512_set1_pd(x);
}
FETTLE_INLINE Sums loweredSum(const Sums& z, const Sums& depth, const Sums& low) noexcept {
  return _mm512_min_pd(_mm512_add_pd(z, depth), low);
}
#elif FETTLE_LEVEL == 1
using Sums = __m256d;
FETTLE_INLINE Sums everySum(double x) noexcept {
  return _mm256_set1_pd(x);
}
FETTLE_INLINE Sums loweredSum(const Sums& z, const Sums& depth, const Sums& low) noexcept {
  return _mm256_min_pd(_mm256_add_pd(z, depth), low);
}
#else
using Sums = __m128d;
FETTLE_INLINE Sums everySum(double x) noexcept {
  return _mm_set1_pd(x);
}
FETTLE_INLINE Sums loweredSum(const Sums& z, const Sums& depth, const Sums& low) noexcept {
  return _mm_min_pd(_mm_add_pd(z, depth), low);
}
#endif

// Eight registers of `depths`, kPlaces * 8 doubles at a multiple of 64 bytes, in each round.
constexpr int kSumsAtOnce = 8 * static_cast<int>(sizeof(Sums) / sizeof(double));
double sumsAlone(const double* depths, int rounds) noexcept {
  constexpr int kLane = sizeof(Sums) / sizeof(double);
  Sums low[8];
  for (Sums& each : low) each = everySum(1e30);
  const Sums z = everySum(0.5);
  for (int k = 0; k < rounds; ++k) {
    const double* const from = depths + k % (kPlaces / 8) * kSumsAtOnce;
#pragma GCC unroll 8
    for (int i = 0; i < 8; ++i) low[i] = loweredSum(z, load<Sums>(from + i * kLane), low[i]);
  }
  double sum = 0.0;
  for (const Sums& each : low) {
    double lanes[kLane];
    store(lanes, each);
    sum += lanes[0];
  }
  return sum;
}

// Of 16 samples each: how much lower their bowls can be anywhere on a block of results. `heights`: kPlaces * kLanes floats, `bowls`
// three times as many: depths and slopes in turn.
double testsAlone(const float* heights, const float* bowls, int rounds) noexcept {
  const Floats a = Floats{} + 0.3F, b = Floats{} + 0.4F, half_x = Floats{} + 3.5F, half_y = Floats{} + 1.5F;
  const auto size = [](const Floats& v) __attribute__((always_inline)) {
    return reinterpret_cast<Floats>(reinterpret_cast<Ints>(v) & 0x7fffffff);
  };
  Floats low[2] = {Floats{} + 1e30F, Floats{} + 1e30F};
  for (int k = 0; k < rounds; k += 2)
#pragma GCC unroll 2
    for (int i = 0; i < 2; ++i) {
      const int at = (k + i) % kPlaces * kLanes;
      const float* const bowl = bowls + 3 * at;
      const Floats f = load<Floats>(heights + at) + load<Floats>(bowl);
      const Floats least = f - size(load<Floats>(bowl + kLanes) - a) * half_x -
                           size(load<Floats>(bowl + 2 * kLanes) - b) * half_y;
      // As a minimum, which takes no longer than a comparison.
      low[i] = lesserAlone(least, low[i]);
    }
  return static_cast<double>(low[0][0]) + static_cast<double>(low[1][0]);
}
