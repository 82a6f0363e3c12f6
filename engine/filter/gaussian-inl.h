// The kernels of gaussian.cpp; see each_cpu-inl.h. Each output is a chain of fused multiply-adds that begins
// with 0 at the first sample of the window and goes on in order, whatever part of the work a kernel takes at
// once: a weight or a sample that is 0 leaves the sum as it is.

// A hole as a sample of 0 and weight 0.
template <bool kHoles>
FETTLE_INLINE void take(const float* from, Doubles& value, Doubles& there) noexcept {
  value = widened(load<HalfFloats>(from));
  if constexpr (kHoles) {
    there = value == value ? Doubles{} + 1.0 : Doubles{};
    value = value == value ? value : Doubles{};
  }
}

// Four rows of outputs, rows[i] for i in 0 .. 3 + 2 kRadius, n columns rounded up to 8.
template <int kRadius, bool kHoles>
FETTLE_INLINE void downSmall(const GaussianGroup& g) noexcept {
  constexpr int kRows = 4;
  Doubles w[kRadius + 1];
  for (int k = 0; k <= kRadius; ++k) w[k] = Doubles{} + g.weights[k];
  for (int c = 0; c < g.columns; c += 8) {
    Doubles sum[kRows] = {};
    Doubles sum_there[kRows] = {};
#pragma GCC unroll 16
    for (int i = 0; i < kRows + 2 * kRadius; ++i) {
      Doubles x, t;
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
FETTLE_INLINE Doubles alongSmall(const double* from, const Doubles* w) noexcept {
  Doubles sum = {};
#pragma GCC unroll 16
  for (int i = 0; i <= 2 * kRadius; ++i)
    sum = fused(w[i < kRadius ? kRadius - i : i - kRadius], load<Doubles>(from + i), sum);
  return sum;
}

template <int kRadius, bool kHoles>
FETTLE_INLINE void finishSmall(const GaussianGroup& g) noexcept {
  constexpr int kRows = 4;
  Doubles w[kRadius + 1];
  for (int k = 0; k <= kRadius; ++k) w[k] = Doubles{} + g.weights[k];
  for (int c = 0; c < g.out_columns; c += 8) {
    Doubles inverse;
    if constexpr (!kHoles) inverse = load<Doubles>(g.inverse + c);
#pragma GCC unroll 4
    for (int j = 0; j < kRows; ++j) {
      if constexpr (kHoles) inverse = 1.0 / alongSmall<kRadius>(g.there + j * g.stride + c, w);
      const Doubles sum = alongSmall<kRadius>(g.value + j * g.stride + c, w);
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

// sum[j] += weights[i - j] * x for the outputs j that sample i of a window that begins at output 0 reaches,
// with `reached` a constant after unrolling.
template <int kOutputs, int kAbreast>
FETTLE_INLINE void reach(const double* weights, int i, int from, int to, const Doubles* x,
                         Doubles (*sum)[kAbreast]) noexcept {
#pragma GCC unroll 16
  for (int j = 0; j < kOutputs; ++j) {
    if (j < from || j >= to) continue;
    const Doubles w = Doubles{} + weights[i - j];
#pragma GCC unroll 2
    for (int h = 0; h < kAbreast; ++h) sum[j][h] = fused(w, x[h], sum[j][h]);
  }
}

// All of kOutputs neighbouring windows of `taps` >= kOutputs samples: sample(i, x) for i in
// 0 .. taps + kOutputs - 2.
template <int kOutputs, int kAbreast, class Sample>
FETTLE_INLINE void windows(const double* weights, int taps, const Sample& sample,
                           Doubles (*sum)[kAbreast]) noexcept {
  Doubles x[kAbreast];
#pragma GCC unroll 16
  for (int i = 0; i < kOutputs - 1; ++i) {
    sample(i, x);
    reach<kOutputs, kAbreast>(weights, i, 0, i + 1, x, sum);
  }
  for (int i = kOutputs - 1; i < taps; ++i) {
    sample(i, x);
    reach<kOutputs, kAbreast>(weights, i, 0, kOutputs, x, sum);
  }
#pragma GCC unroll 16
  for (int i = 1; i < kOutputs; ++i) {
    sample(taps - 1 + i, x);
    reach<kOutputs, kAbreast>(weights + taps - 1, i, i, kOutputs, x, sum);
  }
}

// Eight vectors of eight: element j of vector i to element i of vector j.
template <class Vector>
FETTLE_INLINE void transpose(Vector* v) noexcept {
#pragma GCC unroll 3
  for (int stage = 0; stage < 3; ++stage) {
    Vector t[8];
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
      t[2 * i] = __builtin_shufflevector(v[i], v[i + 4], 0, 8, 1, 9, 2, 10, 3, 11);
      t[2 * i + 1] = __builtin_shufflevector(v[i], v[i + 4], 4, 12, 5, 13, 6, 14, 7, 15);
    }
#pragma GCC unroll 8
    for (int i = 0; i < 8; ++i) v[i] = t[i];
  }
}

// Eight rows of outputs, turned: value[c * 16 + row].
template <bool kThere>
FETTLE_INLINE void downTurned(const GaussianGroup& g, const float* const* rows, double* to) noexcept {
  for (int c = 0; c < g.columns; c += 8) {
    Doubles sum[8][1] = {};
    windows<8, 1>(
        g.all_weights, g.taps,
        [&](int i, Doubles* x) {
          Doubles value, there;
          take<true>(rows[i] + c, value, there);
          x[0] = kThere ? there : value;
        },
        sum);
    Doubles turned[8];
    for (int j = 0; j < 8; ++j) turned[j] = sum[j][0];
    transpose(turned);
    for (int l = 0; l < 8; ++l) store(to + (c + l) * std::ptrdiff_t{16}, turned[l]);
  }
}

FETTLE_INLINE void downTurnedPlain(const GaussianGroup& g) noexcept {
  for (int c = 0; c < g.columns; c += 8) {
    Doubles sum[16][1] = {};
    windows<16, 1>(
        g.all_weights, g.taps, [&](int i, Doubles* x) { x[0] = widened(load<HalfFloats>(g.rows[i] + c)); },
        sum);
    for (int half = 0; half < 2; ++half) {
      Doubles turned[8];
      for (int j = 0; j < 8; ++j) turned[j] = sum[half * 8 + j][0];
      transpose(turned);
      for (int l = 0; l < 8; ++l) store(g.value + (c + l) * std::ptrdiff_t{16} + half * 8, turned[l]);
    }
  }
}

inline void largeDown(const GaussianGroup& g, bool holes) noexcept {
  if (!holes) return downTurnedPlain(g);
  for (int half = 0; half < 2; ++half) {
    downTurned<false>(g, g.rows + half * 8, g.value + half * 8);
    downTurned<true>(g, g.rows + half * 8, g.there + half * 8);
  }
}

FETTLE_INLINE void alongTurned(const GaussianGroup& g, const double* turned, int c,
                               Doubles (*sum)[2]) noexcept {
  windows<8, 2>(
      g.all_weights, g.taps,
      [&](int i, Doubles* x) {
        const double* from = turned + (c + i) * std::ptrdiff_t{16};
        x[0] = load<Doubles>(from);
        x[1] = load<Doubles>(from + 8);
      },
      sum);
}

inline void largeFinish(const GaussianGroup& g, bool holes) noexcept {
  for (int c = 0; c < g.out_columns; c += 8) {
    Doubles sum[8][2] = {};
    alongTurned(g, g.value, c, sum);
    Doubles inverse[8][2] = {};
    if (holes) {
      alongTurned(g, g.there, c, inverse);
      for (int j = 0; j < 8; ++j)
        for (int h = 0; h < 2; ++h) inverse[j][h] = 1.0 / inverse[j][h];
    } else {
      for (int j = 0; j < 8; ++j)
        for (int h = 0; h < 2; ++h) inverse[j][h] = Doubles{} + g.inverse[c + j];
    }
    for (int half = 0; half < 2; ++half) {
      HalfFloats out[8];
      for (int j = 0; j < 8; ++j) out[j] = narrowed(sum[j][half] * inverse[j][half]);
      transpose(out);
      for (int j = 0; j < 8; ++j) store(g.out[half * 8 + j] + c, out[j]);
    }
  }
}
