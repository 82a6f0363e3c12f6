// The kernel of merge.cpp; see each_cpu-inl.h.

// Sums go to one of 16 places by column, so that their order is fixed and they can be taken side by side.
struct Changes {
  Doubles squares[2] = {};
  Doubles most[2] = {};
  Ints changed = {};
};

template <bool kHoles>
FETTLE_INLINE void count(Changes& changes, const Floats& before, const Floats& after) noexcept {
  for (int h = 0; h < 2; ++h) {
    Doubles d = widened(halfOf(after, h)) - widened(halfOf(before, h));
    if constexpr (kHoles) d = d == d ? d : Doubles{};  // a hole stays a hole
    changes.most[h] = greater(changes.most[h], greater(d, -d));
    changes.squares[h] += d * d;
  }
}

inline TileReport reportOf(const Changes& changes) noexcept {
  TileReport report;
  for (int k = 0; k < kLanes; ++k) {
    report.changed -= changes.changed[k];  // true is -1
    const double most = changes.most[k / 8][k % 8];
    report.max_change = most > report.max_change ? most : report.max_change;
    report.squares += changes.squares[k / 8][k % 8];
  }
  return report;
}

// Bit k of `bits` as the truth of lane k.
FETTLE_INLINE Ints truths(std::uint64_t bits) noexcept {
  const int sixteen = static_cast<int>(bits & 0xffffU);
  constexpr Ints kOwn = {1,      1 << 1, 1 << 2,  1 << 3,  1 << 4,  1 << 5,  1 << 6,  1 << 7,
                         1 << 8, 1 << 9, 1 << 10, 1 << 11, 1 << 12, 1 << 13, 1 << 14, 1 << 15};
  return (kOwn & sixteen) != 0;
}

template <bool kHoles, bool kSomeStay>
TileReport mergeRows(const Tile& before, const float* results, std::ptrdiff_t stride, float sign,
                     std::uint64_t flip, Tile& after) noexcept {
  constexpr int kAcross = kTileSide / kLanes;
  constexpr float kInf = __builtin_inff();
  Changes changes;
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
      for (int q = 0; q < kAcross; ++q) {
        const Floats old = load<Floats>(old_row + q * kLanes);
        const Floats fresh = load<Floats>(results + q * kLanes) * sign;
        Ints differs = fresh != old;
        if constexpr (kHoles) differs &= old == old;
        if constexpr (kSomeStay) differs &= truths(may >> (q * kLanes));
        const Floats now = differs ? fresh + 0.0F : old;
        store(new_row + q * kLanes, now);
        // A comparison with NaN is false, so a hole never replaces a bound.
        low[q] = lesser(now, low[q]);
        high[q] = greater(now, high[q]);
        changes.changed += differs;
        count<kHoles>(changes, old, now);
      }
    }
    for (int q = 0; q < kAcross; ++q)
      for (int b = 0; b < kLanes / kBlockSide; ++b) {
        float least = kInf;
        float most = -kInf;
        for (int c = b * kBlockSide; c < (b + 1) * kBlockSide; ++c) {
          least = low[q][c] < least ? low[q][c] : least;
          most = high[q][c] > most ? high[q][c] : most;
        }
        const auto block = static_cast<std::size_t>(band * kBlockSide + q * kLanes / kBlockSide + b);
        after.block_min[block] = least;
        after.block_max[block] = most;
      }
  }
  return reportOf(changes);
}

inline TileReport merge(const Tile& before, const float* results, std::ptrdiff_t stride, float sign,
                        std::uint64_t flip, Tile& after) noexcept {
  const bool some_stay = before.marked_samples != 0 || flip == 0;
  if (before.nan_samples != 0)
    return some_stay ? mergeRows<true, true>(before, results, stride, sign, flip, after)
                     : mergeRows<true, false>(before, results, stride, sign, flip, after);
  return some_stay ? mergeRows<false, true>(before, results, stride, sign, flip, after)
                   : mergeRows<false, false>(before, results, stride, sign, flip, after);
}

inline TileReport compare(const Tile& before, const Tile& after) noexcept {
  Changes changes;
  for (int i = 0; i < kTileSamples; i += kLanes) {
    const auto a = load<Floats>(before.samples.data() + i);
    const auto b = load<Floats>(after.samples.data() + i);
    changes.changed += (a != b) & (a == a) & (b == b);
    count<true>(changes, a, b);
  }
  return reportOf(changes);
}
