// The kernels of box.cpp; see kernel.h.

template <int kLanes>
FETTLE_INLINE void cutUp(double x, const double* cut, double* parts) noexcept {
  for (int l = 0; l + 1 < kLanes; ++l) {
    parts[l] = (x + cut[l]) - cut[l];
    x -= parts[l];
  }
  parts[kLanes - 1] = x;
}

// Adds the row `enter` (0 if null) and takes away the row `leave` (likewise), n samples each.
template <int kLanes, bool kHoles, bool kEnter, bool kLeave>
FETTLE_INLINE void moveRow(const float* __restrict enter, const float* __restrict leave, int n,
                           double* __restrict sums, std::ptrdiff_t lane_stride, const double* cut) noexcept {
  for (int i = 0; i < n; ++i) {
    double in[kLanes] = {};
    double out[kLanes] = {};
    double counted = 0.0;
    if constexpr (kEnter) {
      const float v = enter[i];
      const bool there = !kHoles || v == v;
      cutUp<kLanes>(there ? static_cast<double>(v) : 0.0, cut, in);
      counted += there ? 1.0 : 0.0;
    }
    if constexpr (kLeave) {
      const float v = leave[i];
      const bool there = !kHoles || v == v;
      cutUp<kLanes>(there ? static_cast<double>(v) : 0.0, cut, out);
      counted -= there ? 1.0 : 0.0;
    }
    for (int l = 0; l < kLanes; ++l) sums[l * lane_stride + i] += in[l] - out[l];
    if constexpr (kHoles) sums[kLanes * lane_stride + i] += counted;
  }
}

template <int kLanes, bool kHoles>
FETTLE_INLINE void moveRows(const float* enter, const float* leave, const Columns& at,
                            const double* cut) noexcept {
  double* sums = at.sums + at.begin;
  const int n = at.end - at.begin;
  if (enter != nullptr && leave != nullptr)
    moveRow<kLanes, kHoles, true, true>(enter, leave, n, sums, at.lane_stride, cut);
  else if (enter != nullptr)
    moveRow<kLanes, kHoles, true, false>(enter, nullptr, n, sums, at.lane_stride, cut);
  else if (leave != nullptr)
    moveRow<kLanes, kHoles, false, true>(nullptr, leave, n, sums, at.lane_stride, cut);
}

// window[c] = sum of columns[c .. c + 2 radius].
FETTLE_INLINE void slide(const double* __restrict columns, int radius, double* __restrict window,
                         int n) noexcept {
  double sum = 0.0;
  for (int j = 0; j <= 2 * radius; ++j) sum += columns[j];
  window[0] = sum;
  const double* enter = columns + 2 * radius;
  const double* leave = columns - 1;
  int c = 1;
  // Four steps at once, so that the chain from one sum to the next is one addition for four samples. The
  // partial steps are differences of two window sums: SumLanes leaves room for them.
  for (; c + 3 < n; c += 4) {
    const double d0 = enter[c] - leave[c];
    const double d1 = d0 + (enter[c + 1] - leave[c + 1]);
    const double d2 = d1 + (enter[c + 2] - leave[c + 2]);
    const double d3 = d2 + (enter[c + 3] - leave[c + 3]);
    window[c] = sum + d0;
    window[c + 1] = sum + d1;
    window[c + 2] = sum + d2;
    window[c + 3] = sum + d3;
    sum += d3;
  }
  for (; c < n; ++c) window[c] = sum += enter[c] - leave[c];
}

// out = sum / count, in double, then one rounding to float.
template <int kLanes>
FETTLE_INLINE void divide(const double* __restrict window, std::ptrdiff_t lane_stride,
                          const double* __restrict count, double rows, float* __restrict out,
                          int n) noexcept {
  for (int c = 0; c < n; ++c) {
    double sum = window[c];
    if constexpr (kLanes == 2) sum += window[lane_stride + c];
    if constexpr (kLanes > 2) sum = roundedSum(window + c, kLanes, lane_stride);
    out[c] = static_cast<float>(sum / (count[c] * rows));
  }
}

template <int kLanes, bool kHoles>
void doRow(const Columns& at, const RowWork& w) noexcept {
  moveRows<kLanes, kHoles>(w.enter, w.leave, at, w.cut);
  for (int l = 0; l < kLanes + (kHoles ? 1 : 0); ++l)
    slide(at.sums + l * at.lane_stride, w.radius, w.window + l * at.lane_stride, w.n);
  if constexpr (kHoles)
    divide<kLanes>(w.window, at.lane_stride, w.window + kLanes * at.lane_stride, 1.0, w.out, w.n);
  else
    divide<kLanes>(w.window, at.lane_stride, w.row_count, w.rows, w.out, w.n);
}

template <bool kHoles>
void addOnly(const float* enter, const Columns& at, const SumLanes& lanes) noexcept {
  switch (lanes.lanes) {
    case 1:
      return moveRows<1, kHoles>(enter, nullptr, at, lanes.cut);
    case 2:
      return moveRows<2, kHoles>(enter, nullptr, at, lanes.cut);
    default:
      return moveRows<SumLanes::kMaxLanes, kHoles>(enter, nullptr, at, lanes.cut);
  }
}
