// The kernels of filter_bounds.cpp; see each_cpu-inl.h. Eight chains at once, more than the latency of an instruction hides.

constexpr int kProductsAtOnce = 8 * kPack;
double productsAlone(int rounds) noexcept {
  Pack v[8];
  for (int i = 0; i < 8; ++i) v[i] = every(0.1 * i);
  const Pack a = every(0.5), b = every(0.25);
  for (int k = 0; k < rounds; ++k)
#pragma GCC unroll 8
    for (int i = 0; i < 8; ++i) v[i] = fused(v[i], a, b);
  double sum = 0.0;
  for (const Pack& each : v) sum += each[0];
  return sum;
}

constexpr int kExtremaAtOnce = 8 * kFloatPack;
double extremaAlone(int rounds) noexcept {
  FloatPack v[8];
  for (int i = 0; i < 8; ++i) v[i] = FloatPack{} + 0.1F * static_cast<float>(i);
  const FloatPack low = FloatPack{} + 0.2F, high = FloatPack{} + 0.4F;
  for (int k = 0; k < rounds; k += 2)
#pragma GCC unroll 8
    for (int i = 0; i < 8; ++i) v[i] = greater(lesser(v[i], high), low);
  double sum = 0.0;
  for (const FloatPack& each : v) sum += each[0];
  return sum;
}

// As many chains as registers hold beside what they need.
constexpr int kChains = 8;
constexpr int kChordsAtOnce = kChains * kFloatPack;
// The nearest cache holds two of these.
constexpr int kPlaces = 64;

// `rows`: 2 * (kPlaces + kChains) * kFloatPack floats, at a multiple of 64 bytes: no chord begins farther from a cache line.
double chordsAlone(const float* rows, int rounds) noexcept {
  FloatPack low[kChains];
  for (int i = 0; i < kChains; ++i) low[i] = FloatPack{} + 1e30F;
  for (int k = 0; k < rounds; ++k) {
    const float* const one = rows + k % kPlaces * kFloatPack;
    const float* const other = one + (kPlaces + kChains) * kFloatPack;
#pragma GCC unroll 8
    for (int i = 0; i < kChains; ++i)
      low[i] = lesser(lesser(load<FloatPack>(one + i * kFloatPack), load<FloatPack>(other + i * kFloatPack)),
                      low[i]);
  }
  double sum = 0.0;
  for (const FloatPack& each : low) sum += each[0];
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

// Of as many samples as a register holds: how much lower their bowls can be anywhere on a block of results. `heights`: kPlaces * kFloatPack floats, `bowls`
// three times as many: depths and slopes in turn.
constexpr int kTestsAtOnce = kFloatPack;
double testsAlone(const float* heights, const float* bowls, int rounds) noexcept {
  const FloatPack a = FloatPack{} + 0.3F, b = FloatPack{} + 0.4F, half_x = FloatPack{} + 3.5F,
                  half_y = FloatPack{} + 1.5F;
  const auto size = [](const FloatPack& v) __attribute__((always_inline)) {
    return reinterpret_cast<FloatPack>(reinterpret_cast<IntPack>(v) & 0x7fffffff);
  };
  FloatPack low[2] = {FloatPack{} + 1e30F, FloatPack{} + 1e30F};
  for (int k = 0; k < rounds; k += 2)
#pragma GCC unroll 2
    for (int i = 0; i < 2; ++i) {
      const int at = (k + i) % kPlaces * kFloatPack;
      const float* const bowl = bowls + 3 * at;
      const FloatPack f = load<FloatPack>(heights + at) + load<FloatPack>(bowl);
      const FloatPack least = f - size(load<FloatPack>(bowl + kFloatPack) - a) * half_x -
                              size(load<FloatPack>(bowl + 2 * kFloatPack) - b) * half_y;
      // As a minimum, which takes no longer than a comparison.
      low[i] = lesser(least, low[i]);
    }
  return static_cast<double>(low[0][0]) + static_cast<double>(low[1][0]);
}

// Of as many pivots as a register holds: one more of those above a rank, in each.
#if !defined(FETTLE_CPU_LEVELS)
using Pivots = Ints;
FETTLE_INLINE Pivots everyPivot(int x) noexcept {
  return Ints{} + x;
}
FETTLE_INLINE Pivots countedAbove(const Pivots& counts, const Pivots& pivots, int rank) noexcept {
  return counts - (pivots > rank);
}
#elif FETTLE_LEVEL == 2
using Pivots = __m512i;
FETTLE_INLINE Pivots everyPivot(int x) noexcept {
  return _mm512_set1_epi32(x);
}
FETTLE_INLINE Pivots countedAbove(Pivots counts, Pivots pivots, int rank) noexcept {
  const __mmask16 above = _mm512_cmpgt_epi32_mask(pivots, everyPivot(rank));
  return _mm512_mask_sub_epi32(counts, above, counts, everyPivot(-1));
}
#elif FETTLE_LEVEL == 1
using Pivots = __m256i;
FETTLE_INLINE Pivots everyPivot(int x) noexcept {
  return _mm256_set1_epi32(x);
}
FETTLE_INLINE Pivots countedAbove(Pivots counts, Pivots pivots, int rank) noexcept {
  return _mm256_sub_epi32(counts, _mm256_cmpgt_epi32(pivots, everyPivot(rank)));
}
#else
using Pivots = __m128i;
FETTLE_INLINE Pivots everyPivot(int x) noexcept {
  return _mm_set1_epi32(x);
}
FETTLE_INLINE Pivots countedAbove(Pivots counts, Pivots pivots, int rank) noexcept {
  return _mm_sub_epi32(counts, _mm_cmpgt_epi32(pivots, everyPivot(rank)));
}
#endif

// What a sample does that enters sixteen windows or leaves them.
double movesAlone(RankPlaces& places, int rounds) noexcept {
  constexpr int kParts = sizeof(Ints) / sizeof(Pivots), kLane = sizeof(Pivots) / sizeof(int);
  Pivots pivots[kParts], below[kParts];
  for (int i = 0; i < kParts; ++i) {
    // Different ones, as compilers would otherwise compare once for all.
    pivots[i] = everyPivot(64 * (static_cast<int>(RankPlaces::kWords) / 2 + i));
    below[i] = everyPivot(0);
  }
  for (int k = 0; k < rounds; ++k) {
    const std::uint32_t rank = places.ranks[static_cast<std::size_t>(k) % RankPlaces::kRanks];
    places.shared[rank / 64] ^= std::uint64_t{1} << (rank % 64);
#pragma GCC unroll 4
    for (int i = 0; i < kParts; ++i) below[i] = countedAbove(below[i], pivots[i], static_cast<int>(rank));
  }
  int counts[kParts * kLane];
  for (int i = 0; i < kParts; ++i) store(counts + i * kLane, below[i]);
  return counts[0] + counts[kParts * kLane - 1];
}

double flipsAlone(RankPlaces& places, int rounds) noexcept {
  for (int k = 0; k < rounds; ++k) {
    const std::uint32_t rank = places.ranks[static_cast<std::size_t>(k) % RankPlaces::kRanks];
    places.shared[rank / 64] ^= std::uint64_t{1} << (rank % 64);
  }
  return static_cast<double>(places.shared[0] & 1U);
}

// The bit is one of the first eight that are set; where pdep takes longer than that, the lowest.
double selectionsAlone(RankPlaces& places, int rounds) noexcept {
  for (int k = 0; k < rounds; ++k) {
    const std::size_t at = static_cast<std::size_t>(k) % RankPlaces::kRanks;
    const std::uint32_t rank = places.ranks[at];
    const std::uint32_t word = rank / 64;
    std::uint64_t bits = places.sets[word];
#pragma GCC unroll 4
    for (std::size_t s = 1; s < RankPlaces::kSets; ++s) bits |= places.sets[s * RankPlaces::kWords + word];
#if FETTLE_LEVEL == 2
    bits = _pdep_u64(std::uint64_t{1} << (rank % 8), bits);
#endif
    places.medians[at] = places.heights[word % 16 * 64 + static_cast<std::uint32_t>(__builtin_ctzll(bits))];
  }
  return static_cast<double>(places.medians[0]);
}

double sortsAlone(RankPlaces& places, int rounds) noexcept {
  constexpr std::uint32_t kDigits = 1U << RankPlaces::kDigitBits;
  for (int k = 0; k < rounds; ++k) {
    const RankPlaces::Item item = places.items[static_cast<std::size_t>(k) % RankPlaces::kRanks];
#pragma GCC unroll 3
    for (std::uint32_t p = 0; p < 3; ++p) {
      const std::uint32_t digit = (item.key >> (RankPlaces::kDigitBits * p)) & (kDigits - 1);
      ++places.counters[p * kDigits + digit];
    }
#pragma GCC unroll 3
    for (std::uint32_t p = 0; p < 3; ++p) {
      const std::uint32_t digit = (item.key >> (RankPlaces::kDigitBits * p)) & (kDigits - 1);
      places.moved[places.counters[p * kDigits + digit]++ % RankPlaces::kRanks] = item;
    }
  }
  return places.moved[0].place;
}
