// The kernels of median_rank.cpp; see each_cpu-inl.h.

// Sixteen integers register by register: compilers take comparisons of wider vectors apart to single numbers, or keep them in memory.
#if !defined(FETTLE_CPU_LEVELS)
using IntRegister = Ints;
FETTLE_INLINE IntRegister everyLane(int x) noexcept {
  return Ints{} + x;
}
FETTLE_INLINE IntRegister sumOf(const IntRegister& a, const IntRegister& b) noexcept {
  return a + b;
}
FETTLE_INLINE IntRegister differenceOf(const IntRegister& a, const IntRegister& b) noexcept {
  return a - b;
}
FETTLE_INLINE IntRegister whereAbove(const IntRegister& a, const IntRegister& b,
                                     const IntRegister& of) noexcept {
  return a > b ? of : Ints{};
}
#elif FETTLE_LEVEL == 2
using IntRegister = __m512i;
FETTLE_INLINE IntRegister everyLane(int x) noexcept {
  return _mm512_set1_epi32(x);
}
FETTLE_INLINE IntRegister sumOf(IntRegister a, IntRegister b) noexcept {
  return _mm512_add_epi32(a, b);
}
FETTLE_INLINE IntRegister differenceOf(IntRegister a, IntRegister b) noexcept {
  return _mm512_sub_epi32(a, b);
}
FETTLE_INLINE IntRegister whereAbove(IntRegister a, IntRegister b, IntRegister of) noexcept {
  return _mm512_maskz_mov_epi32(_mm512_cmpgt_epi32_mask(a, b), of);
}
#elif FETTLE_LEVEL == 1
using IntRegister = __m256i;
FETTLE_INLINE IntRegister everyLane(int x) noexcept {
  return _mm256_set1_epi32(x);
}
FETTLE_INLINE IntRegister sumOf(IntRegister a, IntRegister b) noexcept {
  return _mm256_add_epi32(a, b);
}
FETTLE_INLINE IntRegister differenceOf(IntRegister a, IntRegister b) noexcept {
  return _mm256_sub_epi32(a, b);
}
FETTLE_INLINE IntRegister whereAbove(IntRegister a, IntRegister b, IntRegister of) noexcept {
  return _mm256_and_si256(_mm256_cmpgt_epi32(a, b), of);
}
#else
using IntRegister = __m128i;
FETTLE_INLINE IntRegister everyLane(int x) noexcept {
  return _mm_set1_epi32(x);
}
FETTLE_INLINE IntRegister sumOf(IntRegister a, IntRegister b) noexcept {
  return _mm_add_epi32(a, b);
}
FETTLE_INLINE IntRegister differenceOf(IntRegister a, IntRegister b) noexcept {
  return _mm_sub_epi32(a, b);
}
FETTLE_INLINE IntRegister whereAbove(IntRegister a, IntRegister b, IntRegister of) noexcept {
  return _mm_and_si128(_mm_cmpgt_epi32(a, b), of);
}
#endif

struct Sixteen {
  static constexpr int kParts = sizeof(Ints) / sizeof(IntRegister), kLane = kLanes / kParts;
  IntRegister part[kParts];

  FETTLE_INLINE explicit Sixteen(const std::int32_t* from) noexcept {
#pragma GCC unroll 4
    for (int i = 0; i < kParts; ++i) part[i] = load<IntRegister>(from + i * kLane);
  }
  FETTLE_INLINE void to(std::int32_t* there) const noexcept {
#pragma GCC unroll 4
    for (int i = 0; i < kParts; ++i) store(there + i * kLane, part[i]);
  }
  // One more or one less in the `lanes`, 1 or 0.
  template <int kSign>
  FETTLE_INLINE void count(const Sixteen& lanes) noexcept {
#pragma GCC unroll 4
    for (int i = 0; i < kParts; ++i)
      part[i] = kSign > 0 ? sumOf(part[i], lanes.part[i]) : differenceOf(part[i], lanes.part[i]);
  }
  template <int kSign>
  FETTLE_INLINE void countAbove(const Sixteen& pivots, int rank, const Sixteen& lanes) noexcept {
    const IntRegister ranks = everyLane(rank);
#pragma GCC unroll 4
    for (int i = 0; i < kParts; ++i) {
      const IntRegister some = whereAbove(pivots.part[i], ranks, lanes.part[i]);
      part[i] = kSign > 0 ? sumOf(part[i], some) : differenceOf(part[i], some);
    }
  }
};

// Flips the samples of one row into the windows (kSign = 1) or out of them (-1): ranks[x] for the columns x
// in [begin, end) of the group.
template <int kSign, bool kHoles>
FETTLE_INLINE void moveRow(WindowGroup& g, const std::uint32_t* ranks, int begin, int end) noexcept {
  const Sixteen pivots(g.pivots);
  Sixteen below(g.below), sizes(g.sizes);
  const auto count = [&](std::uint32_t rank, const Sixteen& lanes) __attribute__((always_inline)) {
    below.template countAbove<kSign>(pivots, static_cast<int>(rank), lanes);
    if constexpr (kHoles)
      if (rank < g.hole_rank) sizes.template count<kSign>(lanes);
  };
  const auto atTheSides = [&](int from, int to) {
    for (int x = from; x < to; ++x) {
      const std::uint32_t rank = ranks[x];
      const Column& column = g.columns[x < g.lanes ? x : x - g.window + g.lanes];
      for (int i = 0; i < column.count; ++i)
        g.sets[column.sets[i]][rank >> 6] ^= std::uint64_t{1} << (rank & 63U);
      count(rank, Sixteen(column.lanes));
    }
  };
  const int shared_begin = g.lanes - 1 > begin ? g.lanes - 1 : begin;
  const int shared_end = g.window < end ? g.window : end;
  atTheSides(begin, shared_begin < end ? shared_begin : end);
  const Sixteen all(g.all_lanes);
  std::uint64_t* shared = g.sets[0];
  for (int x = shared_begin; x < shared_end; ++x) {
    const std::uint32_t rank = ranks[x];
    shared[rank >> 6] ^= std::uint64_t{1} << (rank & 63U);
    count(rank, all);
  }
  atTheSides(shared_end > begin ? shared_end : begin, end);
  below.to(g.below);
  if constexpr (kHoles) sizes.to(g.sizes);
}

template <int kSign>
void moveGroup(WindowGroup& g, const std::uint32_t* ranks, int begin, int end, bool holes) noexcept {
  if (holes)
    moveRow<kSign, true>(g, ranks, begin, end);
  else
    moveRow<kSign, false>(g, ranks, begin, end);
}

// The samples of all sets that the window of a lane is made of, in one word.
template <int kLevels>
struct Words {
  const std::uint64_t* sets[kLevels];
  FETTLE_INLINE std::uint64_t operator[](std::uint32_t word) const noexcept {
    std::uint64_t bits = sets[0][word];
#pragma GCC unroll 5
    for (int l = 1; l < kLevels; ++l) bits |= sets[l][word];
    return bits;
  }
};

// Where a sample is: its word, and of this its own bit, as the lowest, and those above.
struct Found {
  std::uint32_t word;
  std::uint64_t bits;
};

FETTLE_INLINE std::uint64_t withoutLowest(std::uint64_t bits, std::uint64_t count) noexcept {
#if FETTLE_LEVEL == 2
  // Processors with AVX2 alone may take a hundred cycles for this.
  const std::uint64_t own = _pdep_u64(std::uint64_t{1} << count, bits);
  return bits & (std::uint64_t{} - own);
#else
  for (; count > 0; --count) bits &= bits - 1;
  return bits;
#endif
}

// The k-th smallest of a window, k from 0. `pivot`, a multiple of 64 ranks, and how many are below it follow it.
#if FETTLE_LEVEL == 2
// Eight words at once, a line of the cache of each set.
template <int kLevels>
FETTLE_INLINE __m512i lineOf(const Words<kLevels>& words, std::size_t line) noexcept {
  __m512i bits = _mm512_load_si512(words.sets[0] + kLineWords * line);
#pragma GCC unroll 5
  for (int l = 1; l < kLevels; ++l)
    bits = _mm512_or_si512(bits, _mm512_load_si512(words.sets[l] + kLineWords * line));
  return bits;
}

// The bits that are set in each word: of half a byte by a table, and then the sum of eight bytes.
FETTLE_INLINE __m512i onesOf(__m512i words) noexcept {
  const __m512i ones = _mm512_broadcast_i32x4(_mm_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4));
  const __m512i low = _mm512_set1_epi8(15);
  const __m512i halves =
      _mm512_add_epi8(_mm512_shuffle_epi8(ones, _mm512_and_si512(words, low)),
                      _mm512_shuffle_epi8(ones, _mm512_and_si512(_mm512_srli_epi16(words, 4), low)));
  return _mm512_sad_epu8(halves, _mm512_setzero_si512());
}

// Sums of the lanes up to each.
FETTLE_INLINE __m512i sumsOf(__m512i v) noexcept {
  const __m512i zero = _mm512_setzero_si512();
  v = _mm512_add_epi64(v, _mm512_alignr_epi64(v, zero, 7));
  v = _mm512_add_epi64(v, _mm512_alignr_epi64(v, zero, 6));
  return _mm512_add_epi64(v, _mm512_alignr_epi64(v, zero, 4));
}

FETTLE_INLINE std::uint64_t laneOf(__m512i v, int lane) noexcept {
  return static_cast<std::uint64_t>(
      _mm_cvtsi128_si64(_mm512_castsi512_si128(_mm512_permutexvar_epi64(_mm512_set1_epi64(lane), v))));
}

// Few lines are passed from one row to the next, and mostly as many: the numbers of single words differ, which branch prediction misses.
template <int kLevels>
FETTLE_INLINE Found kthOf(const Words<kLevels>& words, int k, int& pivot, int& below) noexcept {
  constexpr std::uint32_t kLineRanks = 64 * kLineWords;
  std::uint32_t line = static_cast<std::uint32_t>(pivot) / kLineRanks;
  while (below > k) below -= static_cast<int>(_mm512_reduce_add_epi64(onesOf(lineOf(words, --line))));
  for (;; ++line) {
    const __m512i bits = lineOf(words, line), ones = onesOf(bits), sums = sumsOf(ones);
    const __mmask8 passed = _mm512_cmple_epi64_mask(sums, _mm512_set1_epi64(k - below));
    if (passed == 0xff) {
      below += static_cast<int>(laneOf(sums, kLineWords - 1));
      continue;
    }
    pivot = static_cast<int>(line * kLineRanks);
    const int at = __builtin_popcount(passed);
    const std::uint64_t nth =
        static_cast<std::uint64_t>(k - below) - laneOf(_mm512_sub_epi64(sums, ones), at);
    return {line * static_cast<std::uint32_t>(kLineWords) + static_cast<std::uint32_t>(at),
            withoutLowest(laneOf(bits, at), nth)};
  }
}
#else
template <int kLevels>
FETTLE_INLINE Found kthOf(const Words<kLevels>& words, int k, int& pivot, int& below) noexcept {
  auto word = static_cast<std::uint32_t>(pivot) >> 6;
  while (below > k) below -= __builtin_popcountll(words[--word]);
  std::uint64_t bits = words[word];
  for (int here = __builtin_popcountll(bits); below + here <= k; here = __builtin_popcountll(bits)) {
    below += here;
    bits = words[++word];
  }
  pivot = static_cast<int>(word << 6);
  return {word, withoutLowest(bits, static_cast<std::uint64_t>(k - below))};
}
#endif

// The medians of the lanes [0, n) to out; a window without a sample has a hole for its centre: nobody reads
// its output.
template <int kLevels>
FETTLE_INLINE void mediansOf(WindowGroup& g, const float* heights, int n, float* out) noexcept {
  for (int lane = 0; lane < n; ++lane) {
    const int size = g.sizes[lane];
    if (size <= 0) continue;
    Words<kLevels> words;
    for (int l = 0; l < kLevels; ++l) words.sets[l] = g.sets[(1 << l) - 1 + (lane >> (kLevels - 1 - l))];
    auto [word, bits] = kthOf(words, (size - 1) / 2, g.pivots[lane], g.below[lane]);
    const float low = heights[(word << 6) + static_cast<std::uint32_t>(__builtin_ctzll(bits))];
    if (size % 2 != 0) {
      out[lane] = low;
      continue;
    }
    bits &= bits - 1;
    while (bits == 0) bits = words[++word];
    out[lane] = midpoint(low, heights[(word << 6) + static_cast<std::uint32_t>(__builtin_ctzll(bits))]);
  }
}

inline void groupMedians(WindowGroup& g, const float* heights, int n, float* out) noexcept {
  switch (g.lanes) {
    case 16:
      return mediansOf<5>(g, heights, n, out);
    case 8:
      return mediansOf<4>(g, heights, n, out);
    case 4:
      return mediansOf<3>(g, heights, n, out);
    default:
      return mediansOf<2>(g, heights, n, out);
  }
}
