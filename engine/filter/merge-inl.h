// The kernel of merge.cpp; see each_cpu-inl.h.

// Sums go to one of 16 places by column, so that their order is fixed and they can be taken side by side.
struct Changes {
  Doubles squares[2] = {};
  Doubles largest[2] = {};  // of the squares
  Ints changed = {};
};

template <bool kHoles>
FETTLE_INLINE void count(Changes& changes, const float* before, const Floats& after) noexcept {
#pragma GCC unroll 2
  for (int h = 0; h < 2; ++h) {
    Doubles d = widened(halfOf(after, h)) - widened(load<HalfFloats>(before + h * 8));
    if constexpr (kHoles) d = d == d ? d : Doubles{};  // a hole stays a hole
    const Doubles square = d * d;
    changes.largest[h] = greater(square, changes.largest[h]);
    changes.squares[h] += square;
  }
}

inline TileReport reportOf(const Changes& changes) noexcept {
  TileReport report;
  double largest = 0.0;
  for (int k = 0; k < kLanes; ++k) {
    report.changed -= changes.changed[k];  // true is -1
    largest = changes.largest[k / 8][k % 8] > largest ? changes.largest[k / 8][k % 8] : largest;
    report.squares += changes.squares[k / 8][k % 8];
  }
  // The root of a rounded square is the number itself as long as nothing overflows or underflows (S. Boldo,
  // Stupid is as stupid does: taking the square root of the square of a floating-point number, 2015), and
  // differences of floats lie between 2^-149 and 2^129.
  report.max_change = __builtin_sqrt(largest);
  return report;
}

// Bit k of `bits` as the truth of lane k.
FETTLE_INLINE Ints truths(std::uint64_t bits) noexcept {
  const int sixteen = static_cast<int>(bits & 0xffffU);
  constexpr Ints kOwn = {1,      1 << 1, 1 << 2,  1 << 3,  1 << 4,  1 << 5,  1 << 6,  1 << 7,
                         1 << 8, 1 << 9, 1 << 10, 1 << 11, 1 << 12, 1 << 13, 1 << 14, 1 << 15};
  return (kOwn & sixteen) != 0;
}

// What `best` makes of the lanes 0 .. 7 and of 8 .. 15, to to[0] and to[1].
template <class Best>
FETTLE_INLINE void bestOfEight(const Best& best, const Floats& of, float* to) noexcept {
  Floats v = of;
  v = best(v, __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11));
  v = best(v, __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5, 10, 11, 8, 9, 14, 15, 12, 13));
  v = best(v, __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6, 9, 8, 11, 10, 13, 12, 15, 14));
  float lanes[kLanes];
  store(lanes, v);
  to[0] = lanes[0];
  to[1] = lanes[kBlockSide];
}

// `ahead`: what the next block will read, fetched meanwhile; a tile or null.
template <bool kHoles, bool kSomeStay, bool kTurned>
TileReport mergeRows(const Tile& before, const float* results, std::ptrdiff_t stride, std::uint64_t flip,
                     const float* ahead, Tile& after) noexcept {
  constexpr int kAcross = kTileSide / kLanes;
  constexpr float kInf = __builtin_inff();
  Changes changes;
  Floats tile_low = Floats{} + kInf;
  Floats tile_high = Floats{} - kInf;
  const float* old_row = before.samples.data();
  float* new_row = after.samples.data();
  for (int band = 0; band < kTileSide / kBlockSide; ++band) {
    Floats low[kAcross];
    Floats high[kAcross];
    for (int q = 0; q < kAcross; ++q) {
      low[q] = Floats{} + kInf;
      high[q] = Floats{} - kInf;
    }
    for (int r = 0; r < kBlockSide; ++r, old_row += kTileSide, new_row += kTileSide, results += stride) {
      const std::uint64_t may = before.marks[static_cast<std::size_t>(band * kBlockSide + r)] ^ flip;
      if (ahead != nullptr) {
        for (int q = 0; q < kAcross; ++q) __builtin_prefetch(ahead + q * kLanes, 0, 2);
        ahead += kTileSide;
      }
#pragma GCC unroll 4
      for (int q = 0; q < kAcross; ++q) {
        const Floats old = load<Floats>(old_row + q * kLanes);
        Floats fresh = load<Floats>(results + q * kLanes);
        if constexpr (kTurned) fresh = -fresh;
        Ints differs = fresh != old;
        if constexpr (kHoles) differs &= old == old;
        if constexpr (kSomeStay) differs &= truths(may >> (q * kLanes));
        const Floats now = differs ? fresh + 0.0F : old;
        storePast(new_row + q * kLanes, now);
        // A comparison with NaN is false, so a hole never replaces a bound.
        low[q] = lesser(now, low[q]);
        high[q] = greater(now, high[q]);
        changes.changed += differs;
        count<kHoles>(changes, old_row + q * kLanes, now);
      }
    }
#pragma GCC unroll 4
    for (int q = 0; q < kAcross; ++q) {
      tile_low = lesser(low[q], tile_low);
      tile_high = greater(high[q], tile_high);
      const auto block = static_cast<std::size_t>(band * kBlockSide + q * kLanes / kBlockSide);
      bestOfEight([](const Floats& a, const Floats& b) { return lesser(a, b); }, low[q],
                  &after.block_min[block]);
      bestOfEight([](const Floats& a, const Floats& b) { return greater(a, b); }, high[q],
                  &after.block_max[block]);
    }
  }
  after.bounds = {kInf, -kInf};
  for (int k = 0; k < kLanes; ++k) {
    after.bounds.min = tile_low[k] < after.bounds.min ? tile_low[k] : after.bounds.min;
    after.bounds.max = tile_high[k] > after.bounds.max ? tile_high[k] : after.bounds.max;
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
  for (int i = 0; i < kTileSamples; i += kLanes) {
    const auto a = load<Floats>(before.samples.data() + i);
    const auto b = load<Floats>(after.samples.data() + i);
    changes.changed += (a != b) & (a == a) & (b == b);
    count<true>(changes, before.samples.data() + i, b);
  }
  return reportOf(changes);
}
