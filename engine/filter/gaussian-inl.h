// The kernels of gaussian.cpp; see each_cpu-inl.h. Each output is a chain of fused multiply-adds that begins
// with 0 at the first sample of the window and continues in order, whatever part of the work a kernel takes
// at once: a weight or a sample that is 0 leaves the sum as it is.

// A hole as a sample of 0 and weight 0.
template <bool kHoles>
FETTLE_INLINE void take(const float* from, Pack& value, Pack& there) noexcept {
  value = widened(load<HalfPack>(from));
  if constexpr (kHoles) {
    there = value == value ? Pack{} + 1.0 : Pack{};
    value = value == value ? value : Pack{};
  }
}

// Four rows of outputs, rows[i] for i in 0 .. 3 + 2 kRadius, n columns rounded up to kPack.
template <int kRadius, bool kHoles>
FETTLE_INLINE void downSmall(const GaussianGroup& g) noexcept {
  constexpr int kRows = 4;
  Pack w[kRadius + 1];
  for (int k = 0; k <= kRadius; ++k) w[k] = every(g.weights[k]);
  for (int c = 0; c < g.columns; c += kPack) {
    Pack sum[kRows] = {};
    Pack sum_there[kRows] = {};
#pragma GCC unroll 16
    for (int i = 0; i < kRows + 2 * kRadius; ++i) {
      Pack x, t;
      take<kHoles>(g.rows[i] + c, x, t);
#pragma GCC unroll 4
      for (int j = 0; j < kRows; ++j) {
        const int k = i - j < kRadius ? kRadius - (i - j) : i - j - kRadius;
        if (i < j || k > kRadius) continue;
        sum[j] = fused(w[k], x, sum[j]);
        if constexpr (kHoles) sum_there[j] = fused(w[k], t, sum_there[j]);
      }
    }
    for (int j = 0; j < kRows; ++j) {
      store(g.value + j * g.stride + c, sum[j]);
      if constexpr (kHoles) store(g.there + j * g.stride + c, sum_there[j]);
    }
  }
}

template <int kRadius>
FETTLE_INLINE Pack alongSmall(const double* from, const Pack* w) noexcept {
  Pack sum = {};
#pragma GCC unroll 16
  for (int i = 0; i <= 2 * kRadius; ++i)
    sum = fused(w[i < kRadius ? kRadius - i : i - kRadius], load<Pack>(from + i), sum);
  return sum;
}

template <int kRadius, bool kHoles>
FETTLE_INLINE void finishSmall(const GaussianGroup& g) noexcept {
  constexpr int kRows = 4;
  Pack w[kRadius + 1];
  for (int k = 0; k <= kRadius; ++k) w[k] = every(g.weights[k]);
  for (int c = 0; c < g.out_columns; c += kPack) {
    Pack inverse;
    if constexpr (!kHoles) inverse = load<Pack>(g.inverse + c);
#pragma GCC unroll 4
    for (int j = 0; j < kRows; ++j) {
      if constexpr (kHoles) inverse = 1.0 / alongSmall<kRadius>(g.there + j * g.stride + c, w);
      const Pack sum = alongSmall<kRadius>(g.value + j * g.stride + c, w);
      store(g.out[j] + c, narrowed(sum * inverse));
    }
  }
}

template <int kRadius>
void smallDown(const GaussianGroup& g, bool holes) noexcept {
  if (holes)
    downSmall<kRadius, true>(g);
  else
    downSmall<kRadius, false>(g);
}

template <int kRadius>
void smallFinish(const GaussianGroup& g, bool holes) noexcept {
  if (holes)
    finishSmall<kRadius, true>(g);
  else
    finishSmall<kRadius, false>(g);
}

// How many outputs, and registers of each, are summed at once: what the registers hold with samples and a
// weight. With 8 x 2 sums a sample is fetched for eight products and a weight for two, so that fetching keeps
// up with multiplying.
constexpr int kOutputs = FETTLE_LEVEL == 2 ? 8 : 4;
constexpr int kPacks = 2;
constexpr int kAcross = kSide / kPack;  // registers that the columns or rows side by side take

// sum[j] += weights[-j] * x for the outputs j in [from, to), constants after unrolling.
FETTLE_INLINE void reach(const double* weights, int from, int to, const double* sample,
                         Pack (*sum)[kPacks]) noexcept {
  Pack x[kPacks];
#pragma GCC unroll 2
  for (int h = 0; h < kPacks; ++h) x[h] = load<Pack>(sample + kPack * h);
#pragma GCC unroll 8
  for (int j = 0; j < kOutputs; ++j) {
    if (j < from || j >= to) continue;
    const Pack w = every(weights[-j]);
#pragma GCC unroll 2
    for (int h = 0; h < kPacks; ++h) sum[j][h] = fused(w, x[h], sum[j][h]);
  }
}

// Windows of `taps` >= 8 samples that begin at eight neighbouring samples; a sample is kSide doubles.
FETTLE_INLINE void windows(const double* weights, int taps, const double* samples,
                           Pack (*all)[kAcross]) noexcept {
#pragma GCC unroll 2
  for (int first = 0; first < 8; first += kOutputs)
#pragma GCC unroll 4
    for (int part = 0; part < kAcross; part += kPacks) {
      Pack sum[kOutputs][kPacks] = {};
      const double* sample = samples + first * kSide + part * kPack;
      const double* weight = weights;
#pragma GCC unroll 8
      for (int i = 0; i < kOutputs - 1; ++i, ++weight, sample += kSide) reach(weight, 0, i + 1, sample, sum);
      for (int i = kOutputs - 1; i < taps; ++i, ++weight, sample += kSide) {
        // A weight is used by the next output at the next sample. Left to itself the compiler carries it
        // over in a register and spreads it again, which costs more than fetching it.
        asm("" : "+r"(weight));
        reach(weight, 0, kOutputs, sample, sum);
      }
#pragma GCC unroll 8
      for (int i = 1; i < kOutputs; ++i, ++weight, sample += kSide) reach(weight, i, kOutputs, sample, sum);
#pragma GCC unroll 8
      for (int j = 0; j < kOutputs; ++j)
#pragma GCC unroll 2
        for (int h = 0; h < kPacks; ++h) all[first + j][part + h] = sum[j][h];
    }
}

// As many vectors as each has elements: element j of vector i to element i of vector j.
template <class Vector>
FETTLE_INLINE void transpose(Vector* v) noexcept {
  constexpr int kHalf = kPack / 2;
  constexpr int kStages = kPack == 8 ? 3 : kPack == 4 ? 2 : 1;
#pragma GCC unroll 3
  for (int stage = 0; stage < kStages; ++stage) {
    Vector t[kPack];
#pragma GCC unroll 4
    for (int i = 0; i < kHalf; ++i) {
      if constexpr (kPack == 8) {
        t[2 * i] = __builtin_shufflevector(v[i], v[i + kHalf], 0, 8, 1, 9, 2, 10, 3, 11);
        t[2 * i + 1] = __builtin_shufflevector(v[i], v[i + kHalf], 4, 12, 5, 13, 6, 14, 7, 15);
      } else if constexpr (kPack == 4) {
        t[2 * i] = __builtin_shufflevector(v[i], v[i + kHalf], 0, 4, 1, 5);
        t[2 * i + 1] = __builtin_shufflevector(v[i], v[i + kHalf], 2, 6, 3, 7);
      } else {
        t[2 * i] = __builtin_shufflevector(v[i], v[i + kHalf], 0, 2);
        t[2 * i + 1] = __builtin_shufflevector(v[i], v[i + kHalf], 1, 3);
      }
    }
#pragma GCC unroll 8
    for (int i = 0; i < kPack; ++i) v[i] = t[i];
  }
}

// Sums down 16 columns for the group's rows, turned: rows in parts of kSide, a plane of the group's columns
// for each, and in a plane to[c * kSide + row].
FETTLE_INLINE void downTurned(const GaussianGroup& g, const double* samples, double* to) noexcept {
  for (int first = 0; first < kLargeRows; first += 8) {
    Pack sum[8][kAcross];
    windows(g.all_weights, g.taps, samples + first * kSide, sum);
    double* at = to + first / kSide * g.stride + first % kSide;
#pragma GCC unroll 8
    for (int part = 0; part < kAcross; ++part)
#pragma GCC unroll 4
      for (int row = 0; row < 8; row += kPack) {
        Pack turned[kPack];
#pragma GCC unroll 8
        for (int j = 0; j < kPack; ++j) turned[j] = sum[row + j][part];
        transpose(turned);
#pragma GCC unroll 8
        for (int l = 0; l < kPack; ++l) store(at + (part * kPack + l) * kSide + row, turned[l]);
      }
  }
}

// Samples are widened once for all windows that they are in, 16 columns at a time, which stay near the core.
template <bool kHoles>
FETTLE_INLINE void down(const GaussianGroup& g) noexcept {
  const int rows = kLargeRows + g.taps - 1;
  double* there = g.strip + rows * kSide;
  for (int c = 0; c < g.columns; c += kSide) {
    for (int i = 0; i < rows; ++i) {
      for (int h = 0; h < kSide; h += kPack) {
        Pack x, t;
        take<kHoles>(g.rows[i] + c + h, x, t);
        store(g.strip + i * kSide + h, x);
        if constexpr (kHoles) store(there + i * kSide + h, t);
      }
    }
    downTurned(g, g.strip, g.value + c * std::ptrdiff_t{kSide});
    if constexpr (kHoles) downTurned(g, there, g.there + c * std::ptrdiff_t{kSide});
  }
}

inline void largeDown(const GaussianGroup& g, bool holes) noexcept {
  if (holes)
    down<true>(g);
  else
    down<false>(g);
}

// The pass along kSide rows from their plane.
template <bool kHoles>
FETTLE_INLINE void finishPart(const GaussianGroup& g, const double* value, const double* there,
                              float* const* rows) noexcept {
  for (int c = 0; c < g.out_columns; c += 8) {
    Pack sum[8][kAcross];
    windows(g.all_weights, g.taps, value + c * std::ptrdiff_t{kSide}, sum);
    if constexpr (kHoles) {
      Pack weight[8][kAcross];
      windows(g.all_weights, g.taps, there + c * std::ptrdiff_t{kSide}, weight);
      for (int j = 0; j < 8; ++j)
        for (int h = 0; h < kAcross; ++h) sum[j][h] *= 1.0 / weight[j][h];
    } else {
#pragma GCC unroll 8
      for (int j = 0; j < 8; ++j)
#pragma GCC unroll 8
        for (int h = 0; h < kAcross; ++h) sum[j][h] *= every(g.inverse[c + j]);
    }
#pragma GCC unroll 8
    for (int part = 0; part < kAcross; ++part)
#pragma GCC unroll 4
      for (int column = 0; column < 8; column += kPack) {
        HalfPack out[kPack];
#pragma GCC unroll 8
        for (int j = 0; j < kPack; ++j) out[j] = narrowed(sum[column + j][part]);
        transpose(out);
#pragma GCC unroll 8
        for (int j = 0; j < kPack; ++j) store(rows[part * kPack + j] + c + column, out[j]);
      }
  }
}

template <bool kHoles>
FETTLE_INLINE void finish(const GaussianGroup& g) noexcept {
  for (int part = 0; part < kLargeRows / kSide; ++part)
    finishPart<kHoles>(g, g.value + part * g.stride, kHoles ? g.there + part * g.stride : nullptr,
                       g.out + part * kSide);
}

inline void largeFinish(const GaussianGroup& g, bool holes) noexcept {
  if (holes)
    finish<true>(g);
  else
    finish<false>(g);
}
