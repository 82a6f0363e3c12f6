// The kernel of merge.cpp; see each_cpu-inl.h.

// Sixteen samples register by register where one does not hold them all: GCC takes comparisons and choices of wider vectors apart to
// single numbers, which took twelve times as long.
#if defined(FETTLE_CPU_LEVELS) && FETTLE_LEVEL == 1
using FloatPart = __m256;
using IntPart = __m256i;
using DoublePart = __m256d;
FETTLE_INLINE IntPart unequal(FloatPart a, FloatPart b) noexcept {
  return _mm256_castps_si256(_mm256_cmp_ps(a, b, _CMP_NEQ_UQ));
}
FETTLE_INLINE IntPart thereIn(FloatPart a) noexcept {
  return _mm256_castps_si256(_mm256_cmp_ps(a, a, _CMP_ORD_Q));
}
FETTLE_INLINE IntPart both(IntPart a, IntPart b) noexcept {
  return _mm256_and_si256(a, b);
}
FETTLE_INLINE IntPart oneMore(IntPart counts, IntPart where) noexcept {
  return _mm256_add_epi32(counts, where);
}
FETTLE_INLINE FloatPart chosen(IntPart where, FloatPart a, FloatPart b) noexcept {
  return _mm256_blendv_ps(b, a, _mm256_castsi256_ps(where));
}
FETTLE_INLINE FloatPart withoutNegativeZero(FloatPart a) noexcept {
  return _mm256_add_ps(a, _mm256_setzero_ps());
}
FETTLE_INLINE FloatPart negated(FloatPart a) noexcept {
  return _mm256_xor_ps(a, _mm256_set1_ps(-0.0F));
}
FETTLE_INLINE FloatPart lower(FloatPart a, FloatPart b) noexcept {
  return _mm256_min_ps(a, b);
}
FETTLE_INLINE FloatPart higher(FloatPart a, FloatPart b) noexcept {
  return _mm256_max_ps(a, b);
}
FETTLE_INLINE void streamPart(float* to, FloatPart a) noexcept {
  _mm256_stream_ps(to, a);
}
FETTLE_INLINE IntPart truthsOf(int bits) noexcept {
  const IntPart own = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  return _mm256_cmpeq_epi32(_mm256_and_si256(own, _mm256_set1_epi32(bits)), own);
}
FETTLE_INLINE DoublePart wideHalf(FloatPart a, int half) noexcept {
  return _mm256_cvtps_pd(half == 0 ? _mm256_castps256_ps128(a) : _mm256_extractf128_ps(a, 1));
}
FETTLE_INLINE DoublePart differenceOf(DoublePart a, DoublePart b) noexcept {
  return _mm256_sub_pd(a, b);
}
FETTLE_INLINE DoublePart zeroIfNan(DoublePart a) noexcept {
  return _mm256_and_pd(a, _mm256_cmp_pd(a, a, _CMP_ORD_Q));
}
FETTLE_INLINE DoublePart productOf(DoublePart a, DoublePart b) noexcept {
  return _mm256_mul_pd(a, b);
}
FETTLE_INLINE DoublePart sumOf(DoublePart a, DoublePart b) noexcept {
  return _mm256_add_pd(a, b);
}
FETTLE_INLINE DoublePart higher(DoublePart a, DoublePart b) noexcept {
  return _mm256_max_pd(a, b);
}
#elif defined(FETTLE_CPU_LEVELS) && FETTLE_LEVEL == 0
using FloatPart = __m128;
using IntPart = __m128i;
using DoublePart = __m128d;
FETTLE_INLINE IntPart unequal(FloatPart a, FloatPart b) noexcept {
  return _mm_castps_si128(_mm_cmpneq_ps(a, b));
}
FETTLE_INLINE IntPart thereIn(FloatPart a) noexcept {
  return _mm_castps_si128(_mm_cmpord_ps(a, a));
}
FETTLE_INLINE IntPart both(IntPart a, IntPart b) noexcept {
  return _mm_and_si128(a, b);
}
FETTLE_INLINE IntPart oneMore(IntPart counts, IntPart where) noexcept {
  return _mm_add_epi32(counts, where);
}
FETTLE_INLINE FloatPart chosen(IntPart where, FloatPart a, FloatPart b) noexcept {
  const FloatPart mask = _mm_castsi128_ps(where);
  return _mm_or_ps(_mm_and_ps(mask, a), _mm_andnot_ps(mask, b));
}
FETTLE_INLINE FloatPart withoutNegativeZero(FloatPart a) noexcept {
  return _mm_add_ps(a, _mm_setzero_ps());
}
FETTLE_INLINE FloatPart negated(FloatPart a) noexcept {
  return _mm_xor_ps(a, _mm_set1_ps(-0.0F));
}
FETTLE_INLINE FloatPart lower(FloatPart a, FloatPart b) noexcept {
  return _mm_min_ps(a, b);
}
FETTLE_INLINE FloatPart higher(FloatPart a, FloatPart b) noexcept {
  return _mm_max_ps(a, b);
}
FETTLE_INLINE void streamPart(float* to, FloatPart a) noexcept {
  _mm_storeu_ps(to, a);
}
FETTLE_INLINE IntPart truthsOf(int bits) noexcept {
  const IntPart own = _mm_setr_epi32(1, 2, 4, 8);
  return _mm_cmpeq_epi32(_mm_and_si128(own, _mm_set1_epi32(bits)), own);
}
FETTLE_INLINE DoublePart wideHalf(FloatPart a, int half) noexcept {
  return _mm_cvtps_pd(half == 0 ? a : _mm_movehl_ps(a, a));
}
FETTLE_INLINE DoublePart differenceOf(DoublePart a, DoublePart b) noexcept {
  return _mm_sub_pd(a, b);
}
FETTLE_INLINE DoublePart zeroIfNan(DoublePart a) noexcept {
  return _mm_and_pd(a, _mm_cmpord_pd(a, a));
}
FETTLE_INLINE DoublePart productOf(DoublePart a, DoublePart b) noexcept {
  return _mm_mul_pd(a, b);
}
FETTLE_INLINE DoublePart sumOf(DoublePart a, DoublePart b) noexcept {
  return _mm_add_pd(a, b);
}
FETTLE_INLINE DoublePart higher(DoublePart a, DoublePart b) noexcept {
  return _mm_max_pd(a, b);
}
#else
using FloatPart = Floats;
using IntPart = Ints;
using DoublePart = Doubles;
FETTLE_INLINE IntPart unequal(const FloatPart& a, const FloatPart& b) noexcept {
  return a != b;
}
FETTLE_INLINE IntPart thereIn(const FloatPart& a) noexcept {
  return a == a;
}
FETTLE_INLINE IntPart both(const IntPart& a, const IntPart& b) noexcept {
  return a & b;
}
FETTLE_INLINE IntPart oneMore(const IntPart& counts, const IntPart& where) noexcept {
  return counts + where;
}
FETTLE_INLINE FloatPart chosen(const IntPart& where, const FloatPart& a, const FloatPart& b) noexcept {
  return where ? a : b;
}
FETTLE_INLINE FloatPart withoutNegativeZero(const FloatPart& a) noexcept {
  return a + 0.0F;
}
FETTLE_INLINE FloatPart negated(const FloatPart& a) noexcept {
  return -a;
}
FETTLE_INLINE FloatPart lower(const FloatPart& a, const FloatPart& b) noexcept {
  return lesser(a, b);
}
FETTLE_INLINE FloatPart higher(const FloatPart& a, const FloatPart& b) noexcept {
  return greater(a, b);
}
FETTLE_INLINE void streamPart(float* to, const FloatPart& a) noexcept {
  storePast(to, a);
}
// Bit k of `bits` as the truth of lane k.
FETTLE_INLINE IntPart truthsOf(int bits) noexcept {
  constexpr Ints kOwn = {1,      1 << 1, 1 << 2,  1 << 3,  1 << 4,  1 << 5,  1 << 6,  1 << 7,
                         1 << 8, 1 << 9, 1 << 10, 1 << 11, 1 << 12, 1 << 13, 1 << 14, 1 << 15};
  return (kOwn & bits) != 0;
}
FETTLE_INLINE DoublePart wideHalf(const FloatPart& a, int half) noexcept {
  return widened(halfOf(a, half));
}
FETTLE_INLINE DoublePart differenceOf(const DoublePart& a, const DoublePart& b) noexcept {
  return a - b;
}
FETTLE_INLINE DoublePart zeroIfNan(const DoublePart& a) noexcept {
  return a == a ? a : Doubles{};
}
FETTLE_INLINE DoublePart productOf(const DoublePart& a, const DoublePart& b) noexcept {
  return a * b;
}
FETTLE_INLINE DoublePart sumOf(const DoublePart& a, const DoublePart& b) noexcept {
  return a + b;
}
FETTLE_INLINE DoublePart higher(const DoublePart& a, const DoublePart& b) noexcept {
  return greater(a, b);
}
#endif
constexpr int kParts = sizeof(Floats) / sizeof(FloatPart), kPartLanes = kLanes / kParts;

// Sums go to one of 16 places by column, so that their order is fixed and they can be taken side by side.
struct Changes {
  DoublePart squares[2 * kParts] = {};
  DoublePart largest[2 * kParts] = {};  // of the squares
  IntPart changed[kParts] = {};
};

template <bool kHoles>
FETTLE_INLINE void count(Changes& changes, int part, const FloatPart& before,
                         const FloatPart& after) noexcept {
#pragma GCC unroll 2
  for (int h = 0; h < 2; ++h) {
    DoublePart d = differenceOf(wideHalf(after, h), wideHalf(before, h));
    if constexpr (kHoles) d = zeroIfNan(d);  // a hole stays a hole
    const DoublePart square = productOf(d, d);
    const int at = 2 * part + h;
    changes.largest[at] = higher(square, changes.largest[at]);
    changes.squares[at] = sumOf(changes.squares[at], square);
  }
}

inline TileReport reportOf(const Changes& changes) noexcept {
  TileReport report;
  double squares[kLanes], most[kLanes], largest = 0.0;
  int changed[kLanes];
  std::memcpy(squares, changes.squares, sizeof squares);
  std::memcpy(most, changes.largest, sizeof most);
  std::memcpy(changed, changes.changed, sizeof changed);
  for (int k = 0; k < kLanes; ++k) {
    report.changed -= changed[k];  // true is -1
    largest = most[k] > largest ? most[k] : largest;
    report.squares += squares[k];
  }
  // The root of a rounded square is the number itself as long as nothing overflows or underflows (S. Boldo,
  // Stupid is as stupid does: taking the square root of the square of a floating-point number, 2015), and
  // differences of floats lie between 2^-149 and 2^129.
  report.max_change = __builtin_sqrt(largest);
  return report;
}

// What `best` makes of the lanes 0 .. 7 and of 8 .. 15, to to[0] and to[1].
template <class Best>
FETTLE_INLINE void bestOfEight(const Best& best, const FloatPart* of, float* to) noexcept {
#if defined(FETTLE_CPU_LEVELS) && FETTLE_LEVEL == 1
#pragma GCC unroll 2
  for (int i = 0; i < 2; ++i) {
    FloatPart v = best(of[i], _mm256_permute2f128_ps(of[i], of[i], 1));
    v = best(v, _mm256_permute_ps(v, 0x4e));
    to[i] = _mm256_cvtss_f32(best(v, _mm256_permute_ps(v, 0xb1)));
  }
#elif defined(FETTLE_CPU_LEVELS) && FETTLE_LEVEL == 0
#pragma GCC unroll 2
  for (int i = 0; i < 2; ++i) {
    FloatPart v = best(of[2 * i], of[2 * i + 1]);
    v = best(v, _mm_shuffle_ps(v, v, 0x4e));
    to[i] = _mm_cvtss_f32(best(v, _mm_shuffle_ps(v, v, 0xb1)));
  }
#else
  Floats v = of[0];
  v = best(v, __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11));
  v = best(v, __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5, 10, 11, 8, 9, 14, 15, 12, 13));
  v = best(v, __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6, 9, 8, 11, 10, 13, 12, 15, 14));
  float lanes[kLanes];
  store(lanes, v);
  to[0] = lanes[0];
  to[1] = lanes[kBlockSide];
#endif
}

// `ahead`: what the next block will read, fetched meanwhile; a tile or null.
template <bool kHoles, bool kSomeStay, bool kTurned>
TileReport mergeRows(const Tile& before, const float* results, std::ptrdiff_t stride, std::uint64_t flip,
                     const float* ahead, Tile& after) noexcept {
  constexpr int kAcross = kTileSide / kLanes;
  constexpr float kInf = __builtin_inff();
  alignas(64) static constexpr float kHighest[kLanes] = {kInf, kInf, kInf, kInf, kInf, kInf, kInf, kInf,
                                                         kInf, kInf, kInf, kInf, kInf, kInf, kInf, kInf};
  alignas(64) static constexpr float kLowest[kLanes] = {-kInf, -kInf, -kInf, -kInf, -kInf, -kInf,
                                                        -kInf, -kInf, -kInf, -kInf, -kInf, -kInf,
                                                        -kInf, -kInf, -kInf, -kInf};
  Changes changes;
  FloatPart tile_low[kParts], tile_high[kParts];
  for (int part = 0; part < kParts; ++part) {
    tile_low[part] = load<FloatPart>(kHighest);
    tile_high[part] = load<FloatPart>(kLowest);
  }
  const float* old_row = before.samples.data();
  float* new_row = after.samples.data();
  for (int band = 0; band < kTileSide / kBlockSide; ++band) {
    FloatPart low[kAcross * kParts], high[kAcross * kParts];
    for (int q = 0; q < kAcross * kParts; ++q) {
      low[q] = load<FloatPart>(kHighest);
      high[q] = load<FloatPart>(kLowest);
    }
    for (int r = 0; r < kBlockSide; ++r, old_row += kTileSide, new_row += kTileSide, results += stride) {
      const std::uint64_t may = before.marks[static_cast<std::size_t>(band * kBlockSide + r)] ^ flip;
      if (ahead != nullptr) {
        for (int q = 0; q < kAcross; ++q) __builtin_prefetch(ahead + q * kLanes, 0, 2);
        ahead += kTileSide;
      }
#pragma GCC unroll 16
      for (int q = 0; q < kAcross * kParts; ++q) {
        const auto old = load<FloatPart>(old_row + q * kPartLanes);
        auto fresh = load<FloatPart>(results + q * kPartLanes);
        if constexpr (kTurned) fresh = negated(fresh);
        IntPart differs = unequal(fresh, old);
        if constexpr (kHoles) differs = both(differs, thereIn(old));
        if constexpr (kSomeStay)
          differs = both(differs, truthsOf(static_cast<int>((may >> (q * kPartLanes)) & 0xffffU)));
        const FloatPart now = chosen(differs, withoutNegativeZero(fresh), old);
        streamPart(new_row + q * kPartLanes, now);
        // A comparison with NaN is false, so a hole never replaces a bound.
        low[q] = lower(now, low[q]);
        high[q] = higher(now, high[q]);
        changes.changed[q % kParts] = oneMore(changes.changed[q % kParts], differs);
        count<kHoles>(changes, q % kParts, old, now);
      }
    }
#pragma GCC unroll 16
    for (int q = 0; q < kAcross * kParts; ++q) {
      tile_low[q % kParts] = lower(low[q], tile_low[q % kParts]);
      tile_high[q % kParts] = higher(high[q], tile_high[q % kParts]);
    }
#pragma GCC unroll 4
    for (int q = 0; q < kAcross; ++q) {
      const auto block = static_cast<std::size_t>(band * kBlockSide + q * kLanes / kBlockSide);
      bestOfEight(
          [](const FloatPart& a, const FloatPart& b) __attribute__((always_inline)) { return lower(a, b); },
          low + q * kParts, &after.block_min[block]);
      bestOfEight(
          [](const FloatPart& a, const FloatPart& b) __attribute__((always_inline)) { return higher(a, b); },
          high + q * kParts, &after.block_max[block]);
    }
  }
  float lowest[kLanes], highest[kLanes];
  std::memcpy(lowest, tile_low, sizeof lowest);
  std::memcpy(highest, tile_high, sizeof highest);
  after.bounds = {kInf, -kInf};
  for (int k = 0; k < kLanes; ++k) {
    after.bounds.min = lowest[k] < after.bounds.min ? lowest[k] : after.bounds.min;
    after.bounds.max = highest[k] > after.bounds.max ? highest[k] : after.bounds.max;
  }
  pastCaches();
  return reportOf(changes);
}

template <bool kHoles, bool kSomeStay>
TileReport mergeSigned(const Tile& before, const float* results, std::ptrdiff_t stride, float sign,
                       std::uint64_t flip, const float* ahead, Tile& after) noexcept {
  return sign < 0.0F ? mergeRows<kHoles, kSomeStay, true>(before, results, stride, flip, ahead, after)
                     : mergeRows<kHoles, kSomeStay, false>(before, results, stride, flip, ahead, after);
}

inline TileReport merge(const Tile& before, const float* results, std::ptrdiff_t stride, float sign,
                        std::uint64_t flip, const float* ahead, Tile& after) noexcept {
  const bool some_stay = before.marked_samples != 0 || flip == 0;
  if (before.nan_samples != 0)
    return some_stay ? mergeSigned<true, true>(before, results, stride, sign, flip, ahead, after)
                     : mergeSigned<true, false>(before, results, stride, sign, flip, ahead, after);
  return some_stay ? mergeSigned<false, true>(before, results, stride, sign, flip, ahead, after)
                   : mergeSigned<false, false>(before, results, stride, sign, flip, ahead, after);
}

inline TileReport compare(const Tile& before, const Tile& after) noexcept {
  Changes changes;
  for (int i = 0; i < kTileSamples; i += kLanes)
#pragma GCC unroll 4
    for (int part = 0; part < kParts; ++part) {
      const auto a = load<FloatPart>(before.samples.data() + i + part * kPartLanes);
      const auto b = load<FloatPart>(after.samples.data() + i + part * kPartLanes);
      const IntPart differs = both(unequal(a, b), both(thereIn(a), thereIn(b)));
      changes.changed[part] = oneMore(changes.changed[part], differs);
      count<true>(changes, part, a, b);
    }
  return reportOf(changes);
}
