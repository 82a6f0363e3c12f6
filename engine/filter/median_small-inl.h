// The kernels of median_small.cpp; see each_cpu-inl.h.

template <Comparator kStep>
FETTLE_INLINE void exchange(FloatPack* v) noexcept {
  const FloatPack a = v[kStep.low];
  const FloatPack b = v[kStep.high];
  if constexpr (kStep.wants_low) v[kStep.low] = lesser(a, b);
  if constexpr (kStep.wants_high) v[kStep.high] = greater(b, a);
}

template <class Network, std::size_t... kIndex>
FETTLE_INLINE void applySteps(FloatPack* v, std::index_sequence<kIndex...>) noexcept {
  (exchange<Network::kList.steps[kIndex]>(v), ...);
}

template <class Network>
FETTLE_INLINE void apply(FloatPack* v) noexcept {
  applySteps<Network>(v, std::make_index_sequence<Network::kList.count>());
}

// Ranks [kBegin, kEnd) of the ascending a and b together, ascending.
template <int kA, int kB, int kBegin, int kEnd>
FETTLE_INLINE void mergeHere(const FloatPack* a, const FloatPack* b, FloatPack* out) noexcept {
  FloatPack v[kA + kB];
#pragma GCC unroll 64
  for (int i = 0; i < kA; ++i) v[i] = a[i];
#pragma GCC unroll 64
  for (int i = 0; i < kB; ++i) v[kA + i] = b[i];
  apply<Merging<kA, kB, kBegin, kEnd>>(v);
#pragma GCC unroll 64
  for (int i = kBegin; i < kEnd; ++i) out[i - kBegin] = v[i];
}

template <int kA, int kB, int kBegin, int kEnd>
__attribute__((noinline)) void mergeElsewhere(const FloatPack* a, const FloatPack* b,
                                              FloatPack* out) noexcept {
  mergeHere<kA, kB, kBegin, kEnd>(a, b, out);
}

// Lists that fit the registers are merged on the spot, longer ones in a function of their own: many copies of
// them would be more code than the processor keeps.
template <int kA, int kB, int kBegin = 0, int kEnd = kA + kB>
FETTLE_INLINE void merge(const FloatPack* a, const FloatPack* b, FloatPack* out) noexcept {
  if constexpr (kA + kB <= 20 && FETTLE_LEVEL == 2)
    mergeHere<kA, kB, kBegin, kEnd>(a, b, out);
  else
    mergeElsewhere<kA, kB, kBegin, kEnd>(a, b, out);
}

// The middle one of the ascending a (kN + 1 samples) and b (kN): at least kN others are no greater than the
// greater of a[i] and b[kN - 1 - i], and for one i it is the one with exactly kN.
template <int kN>
FETTLE_INLINE FloatPack middle(const FloatPack* a, const FloatPack* b) noexcept {
  FloatPack least = a[kN];
#pragma GCC unroll 16
  for (int i = 0; i < kN; ++i) {
    least = lesser(greater(a[i], b[kN - 1 - i]), least);
  }
  return least;
}

// Medians of kN x kN windows, kN = 5 .. 11, kFloatPack outputs side by side, row after row. Four outputs below
// each other share kN - 3 rows of samples, two of them share kN - 1; what is shared is sorted once, and of
// every sorted list only that part is kept that can still become the median (A. Adams, Fast median filters
// using separable sorting networks, 2021). Counting rows from 1 at the first window's first, the outputs of
// step k have their windows begin in rows 4 k - 3 .. 4 k.
template <int kN>
void medianStrip(const float* corner, std::ptrdiff_t stride, int last_row, int out_rows, float* out,
                 std::ptrdiff_t out_stride) noexcept {
  constexpr int kMedian = (kN * kN - 1) / 2;
  constexpr int kCore = kN * (kN - 3);
  constexpr int kCoreBegin = kMedian - 3 * kN > 0 ? kMedian - 3 * kN : 0;
  constexpr int kCoreEnd = kCore < kMedian + 1 ? kCore : kMedian + 1;
  constexpr int kCoreKept = kCoreEnd - kCoreBegin;
  constexpr int kHalfBegin = kMedian - kN - kCoreBegin;

  FloatPack rows[16][kN];
  FloatPack pairs[8][2 * kN];
  FloatPack quads[4][4 * kN];
  FloatPack core[kCoreKept];
  FloatPack half[kN + 1];
  int row = 1;
  for (int k = 1; 4 * (k - 1) < out_rows; ++k) {
    for (; row < 4 * k + kN; ++row) {
      const float* from = corner + (row - 1 < last_row ? row - 1 : last_row) * stride;
      FloatPack v[kN];
      for (int i = 0; i < kN; ++i) v[i] = load<FloatPack>(from + i);
      apply<Sorting<kN>>(v);
      for (int i = 0; i < kN; ++i) rows[row & 15][i] = v[i];
      if (row % 2 == 1 && row >= 3)
        merge<kN, kN>(rows[(row - 1) & 15], rows[row & 15], pairs[(row >> 1) & 7]);
      if constexpr (kN > 5)
        if (row % 4 == 3 && row >= 7)
          merge<2 * kN, 2 * kN>(pairs[((row >> 1) - 1) & 7], pairs[(row >> 1) & 7], quads[(row >> 2) & 3]);
    }
    const FloatPack* shared = core;
    if constexpr (kN == 5) shared = pairs[(2 * k) & 7];
    if constexpr (kN == 7) shared = quads[k & 3] + kCoreBegin;
    if constexpr (kN == 9)
      merge<4 * kN, 2 * kN, kCoreBegin, kCoreEnd>(quads[k & 3], pairs[(2 * k + 2) & 7], core);
    if constexpr (kN == 11)
      merge<4 * kN, 4 * kN, kCoreBegin, kCoreEnd>(quads[k & 3], quads[(k + 1) & 3], core);
    const int last_pair = (4 * k + kN - 3) / 2;
    for (int side = 0; side < 2; ++side) {
      merge<kCoreKept, 2 * kN, kHalfBegin, kHalfBegin + kN + 1>(
          shared, pairs[(side == 0 ? 2 * k - 1 : last_pair) & 7], half);
      for (int i = 0; i < 2; ++i) {
        const int output = 4 * (k - 1) + 2 * side + i;
        if (output >= out_rows) break;
        const int lone = i == 0 ? 4 * k - 3 + 2 * side : 4 * k + kN - 3 + 2 * side;
        store(out + output * out_stride, middle<kN>(half, rows[lone & 15]));
      }
    }
  }
}

// 3 x 3: sort each column; the median of nine is the median of the largest low, the middle middle and the
// smallest high (J. L. Smith, Implementing median filters in XC4000E FPGAs, 1996). Two outputs below each
// other share the comparison of the two rows they share.
FETTLE_INLINE void threeColumns(const FloatPack& low, const FloatPack& high, const FloatPack& v,
                                FloatPack* sorted) {
  sorted[0] = lesser(low, v);
  const FloatPack rest = greater(low, v);
  sorted[1] = lesser(high, rest);
  sorted[2] = greater(high, rest);
}

FETTLE_INLINE FloatPack middleOfThree(const FloatPack& a, const FloatPack& b, const FloatPack& c) {
  return greater(lesser(a, b), lesser(greater(a, b), c));
}

FETTLE_INLINE FloatPack middleOfNine(const FloatPack (*sorted)[3]) {
  const FloatPack low = greater(greater(sorted[0][0], sorted[1][0]), sorted[2][0]);
  const FloatPack mid = middleOfThree(sorted[0][1], sorted[1][1], sorted[2][1]);
  const FloatPack high = lesser(lesser(sorted[0][2], sorted[1][2]), sorted[2][2]);
  return middleOfThree(low, mid, high);
}

template <>
void medianStrip<3>(const float* corner, std::ptrdiff_t stride, int last_row, int out_rows, float* out,
                    std::ptrdiff_t out_stride) noexcept {
  const auto row = [&](int i) { return corner + (i < last_row ? i : last_row) * stride; };
  for (int r = 0; r < out_rows; r += 2) {
    FloatPack first[3][3];
    FloatPack second[3][3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      const auto b = load<FloatPack>(row(r + 1) + i);
      const auto c = load<FloatPack>(row(r + 2) + i);
      const FloatPack low = lesser(b, c);
      const FloatPack high = greater(b, c);
      threeColumns(low, high, load<FloatPack>(row(r) + i), first[i]);
      threeColumns(low, high, load<FloatPack>(row(r + 3) + i), second[i]);
    }
    const FloatPack medians[2] = {middleOfNine(first), middleOfNine(second)};
    for (int j = 0; j < 2 && r + j < out_rows; ++j) store(out + (r + j) * out_stride, medians[j]);
  }
}

// The middle one of kCount samples of each lane, to lanes[0 .. kFloatPack - 1]; sample i of a lane is lanes[i * kFloatPack + lane].
template <int kCount>
void middleOfLanes(float* lanes) noexcept {
  FloatPack v[kCount];
  for (int i = 0; i < kCount; ++i) v[i] = load<FloatPack>(lanes + i * kFloatPack);
  apply<Selecting<kCount>>(v);
  store(lanes, v[kCount / 2]);
}

inline int medianColumns() noexcept {
  return kFloatPack;
}

// Bit i: row[i] is a hole, i < n <= 64.
std::uint64_t holesOf(const float* row, int n) noexcept {
  std::uint64_t holes = 0;
  for (int i = 0; i < n; ++i) holes |= std::uint64_t{row[i] != row[i]} << i;
  return holes;
}

bool anyHole(const float* row, int n) noexcept {
  int holes = 0;
  for (int i = 0; i < n; ++i) holes |= row[i] != row[i] ? 1 : 0;
  return holes != 0;
}
