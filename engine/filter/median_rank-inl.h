// The kernels of median_rank.cpp; see each_cpu-inl.h.

// Flips the samples of one row into the windows (kSign = 1) or out of them (-1): ranks[x] for the columns x
// in [begin, end) of the group.
template <int kSign, bool kHoles>
FETTLE_INLINE void moveRow(WindowGroup& g, const std::uint32_t* ranks, int begin, int end) noexcept {
  const auto pivots = load<Ints>(g.pivots);
  auto below = load<Ints>(g.below);
  auto sizes = load<Ints>(g.sizes);
  const auto count = [&](std::uint32_t rank, const Ints& lanes) {
    const int r = static_cast<int>(rank);
    below += (pivots > r ? lanes : Ints{}) * kSign;
    if constexpr (kHoles)
      if (rank < g.hole_rank) sizes += lanes * kSign;
  };
  const auto atTheSides = [&](int from, int to) {
    for (int x = from; x < to; ++x) {
      const std::uint32_t rank = ranks[x];
      const Column& column = g.columns[x < g.lanes ? x : x - g.window + g.lanes];
      for (int i = 0; i < column.count; ++i)
        g.sets[column.sets[i]][rank >> 6] ^= std::uint64_t{1} << (rank & 63U);
      count(rank, load<Ints>(column.lanes));
    }
  };
  const int shared_begin = g.lanes - 1 > begin ? g.lanes - 1 : begin;
  const int shared_end = g.window < end ? g.window : end;
  atTheSides(begin, shared_begin < end ? shared_begin : end);
  const auto all = load<Ints>(g.all_lanes);
  std::uint64_t* shared = g.sets[0];
  for (int x = shared_begin; x < shared_end; ++x) {
    const std::uint32_t rank = ranks[x];
    shared[rank >> 6] ^= std::uint64_t{1} << (rank & 63U);
    count(rank, all);
  }
  atTheSides(shared_end > begin ? shared_end : begin, end);
  store(g.below, below);
  if constexpr (kHoles) store(g.sizes, sizes);
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

// The medians of the lanes [0, n) to out; a window without a sample has a hole for its centre: nobody reads
// its output.
template <int kLevels>
FETTLE_INLINE void mediansOf(WindowGroup& g, const float* heights, int n, float* out) noexcept {
  for (int lane = 0; lane < n; ++lane) {
    const int size = g.sizes[lane];
    if (size <= 0) continue;
    Words<kLevels> words;
    for (int l = 0; l < kLevels; ++l) words.sets[l] = g.sets[(1 << l) - 1 + (lane >> (kLevels - 1 - l))];
    // Moves the pivot to the word that holds the k-th smallest, k from 0.
    const int k = (size - 1) / 2;
    int below = g.below[lane];
    auto word = static_cast<std::uint32_t>(g.pivots[lane]) >> 6;
    while (below > k) below -= __builtin_popcountll(words[--word]);
    std::uint64_t bits = words[word];
    for (int here = __builtin_popcountll(bits); below + here <= k; here = __builtin_popcountll(bits)) {
      below += here;
      bits = words[++word];
    }
    g.below[lane] = below;
    g.pivots[lane] = static_cast<int>(word << 6);
    for (int i = below; i < k; ++i) bits &= bits - 1;
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
