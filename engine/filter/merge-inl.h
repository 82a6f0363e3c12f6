// The kernel of merge.cpp; see each_cpu-inl.h.

constexpr int kParts = kLanes / kFloatPack;  // registers that 16 samples take

// Bit k of `bits` as the truth of lane k: all bits set.
FETTLE_INLINE IntPack truthsOf(int bits) noexcept {
#if FETTLE_LEVEL == 2
  constexpr IntPack kOwn = {1,      1 << 1, 1 << 2,  1 << 3,  1 << 4,  1 << 5,  1 << 6,  1 << 7,
                            1 << 8, 1 << 9, 1 << 10, 1 << 11, 1 << 12, 1 << 13, 1 << 14, 1 << 15};
#elif FETTLE_LEVEL == 1
  constexpr IntPack kOwn = {1, 1 << 1, 1 << 2, 1 << 3, 1 << 4, 1 << 5, 1 << 6, 1 << 7};
#else
  constexpr IntPack kOwn = {1, 1 << 1, 1 << 2, 1 << 3};
#endif
  return (kOwn & bits) == kOwn;
}

// Sums go to one of 16 places by column, so that their order is fixed and they can be taken side by side.
struct Changes {
  Pack squares[2 * kParts] = {};
  Pack largest[2 * kParts] = {};  // of the squares
  IntPack changed[kParts] = {};
};

template <bool kHoles>
FETTLE_INLINE void count(Changes& changes, int part, const FloatPack& before,
                         const FloatPack& after) noexcept {
#pragma GCC unroll 2
  for (int h = 0; h < 2; ++h) {
    Pack d = widenedHalf(after, h) - widenedHalf(before, h);
    if constexpr (kHoles) d = d == d ? d : Pack{};  // a hole stays a hole
    const Pack square = d * d;
    const int at = 2 * part + h;
    changes.largest[at] = greater(square, changes.largest[at]);
    changes.squares[at] = changes.squares[at] + square;
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
FETTLE_INLINE void bestOfEight(const Best& best, const FloatPack* of, float* to) noexcept {
#if FETTLE_LEVEL == 1
#pragma GCC unroll 2
  for (int i = 0; i < 2; ++i) {
    FloatPack v = best(of[i], _mm256_permute2f128_ps(of[i], of[i], 1));
    v = best(v, _mm256_permute_ps(v, 0x4e));
    to[i] = _mm256_cvtss_f32(best(v, _mm256_permute_ps(v, 0xb1)));
  }
#elif FETTLE_LEVEL == 0
#pragma GCC unroll 2
  for (int i = 0; i < 2; ++i) {
    FloatPack v = best(of[2 * i], of[2 * i + 1]);
    v = best(v, __builtin_shufflevector(v, v, 2, 3, 0, 1));
    to[i] = best(v, __builtin_shufflevector(v, v, 1, 0, 3, 2))[0];
  }
#else
  FloatPack v = of[0];
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
  FloatPack tile_low[kParts], tile_high[kParts];
  for (int part = 0; part < kParts; ++part) {
    tile_low[part] = load<FloatPack>(kHighest);
    tile_high[part] = load<FloatPack>(kLowest);
  }
  const float* old_row = before.samples.data();
  float* new_row = after.samples.data();
  for (int band = 0; band < kTileSide / kBlockSide; ++band) {
    FloatPack low[kAcross * kParts], high[kAcross * kParts];
    for (int q = 0; q < kAcross * kParts; ++q) {
      low[q] = load<FloatPack>(kHighest);
      high[q] = load<FloatPack>(kLowest);
    }
    for (int r = 0; r < kBlockSide; ++r, old_row += kTileSide, new_row += kTileSide, results += stride) {
      const std::uint64_t may = before.marks[static_cast<std::size_t>(band * kBlockSide + r)] ^ flip;
      if (ahead != nullptr) {
        for (int q = 0; q < kAcross; ++q) __builtin_prefetch(ahead + q * kLanes, 0, 2);
        ahead += kTileSide;
      }
#pragma GCC unroll 16
      for (int q = 0; q < kAcross * kParts; ++q) {
        const auto old = load<FloatPack>(old_row + q * kFloatPack);
        auto fresh = load<FloatPack>(results + q * kFloatPack);
        if constexpr (kTurned) fresh = -fresh;
        IntPack differs = fresh != old;
        if constexpr (kHoles) differs &= old == old;
        if constexpr (kSomeStay) differs &= truthsOf(static_cast<int>((may >> (q * kFloatPack)) & 0xffffU));
        const FloatPack now = differs ? fresh + 0.0F : old;
        storePast(new_row + q * kFloatPack, now);
        // A comparison with NaN is false, so a hole never replaces a bound.
        low[q] = lesser(now, low[q]);
        high[q] = greater(now, high[q]);
        changes.changed[q % kParts] += differs;
        count<kHoles>(changes, q % kParts, old, now);
      }
    }
#pragma GCC unroll 16
    for (int q = 0; q < kAcross * kParts; ++q) {
      tile_low[q % kParts] = lesser(low[q], tile_low[q % kParts]);
      tile_high[q % kParts] = greater(high[q], tile_high[q % kParts]);
    }
#pragma GCC unroll 4
    for (int q = 0; q < kAcross; ++q) {
      const auto block = static_cast<std::size_t>(band * kBlockSide + q * kLanes / kBlockSide);
      bestOfEight(
          [](const FloatPack& a, const FloatPack& b) __attribute__((always_inline)) { return lesser(a, b); },
          low + q * kParts, &after.block_min[block]);
      bestOfEight(
          [](const FloatPack& a, const FloatPack& b) __attribute__((always_inline)) { return greater(a, b); },
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
      const auto a = load<FloatPack>(before.samples.data() + i + part * kFloatPack);
      const auto b = load<FloatPack>(after.samples.data() + i + part * kFloatPack);
      const IntPack differs = (a != b) & (a == a) & (b == b);
      changes.changed[part] += differs;
      count<true>(changes, part, a, b);
    }
  return reportOf(changes);
}
