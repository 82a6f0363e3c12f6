// The kernels of planes.cpp; see kernel.h. Rows of doubles begin at a first column that is readable 8 elements to its
// left and are read and written in vectors of 8: 16 elements beyond the last column are readable and finite.

// Heights of a row above a reference, in noises; holes are 0. n is rounded up to 8 by the caller.
void heightsInNoises(const float* z, int n, double reference, double per_noise, double tallest,
                     double* __restrict out) noexcept {
  const Doubles least = spread(-tallest), most = spread(tallest), none{};
  for (int c = 0; c < n; c += 8) {
    const Doubles wide = widened(load<HalfFloats>(z + c));
    const Doubles above = (wide - spread(reference)) * spread(per_noise);
    store(out + c, wide == wide ? lesser(greater(above, least), most) : none);
  }
}

// What the window of half-width h adds to the sums of its columns beyond the next smaller window.
template <int kFrom, int kTo>
FETTLE_INLINE void widenColumns(const double* const* middle, int c, Doubles& sum, Doubles& up,
                                Doubles& square) noexcept {
  for (int k = kFrom; k <= kTo; ++k) {
    const Doubles above = load<Doubles>(middle[k] + c), below = load<Doubles>(middle[-k] + c);
    sum += above + below;
    up += spread(k) * (above - below);
    square += above * above + below * below;
  }
}

// Of each column of the rows around middle[0], for each window: the sum of z, of z times its row from the middle, and of
// z squared. to[3 * window + figure]
void sumColumns(const double* const* middle, int n, double* const* to) noexcept {
  for (int c = 0; c < n; c += 8) {
    const Doubles z = load<Doubles>(middle[0] + c);
    Doubles sum = z, up{}, square = z * z;
    const auto keep = [&](int window) {
      store(to[3 * window] + c, sum);
      store(to[3 * window + 1] + c, up);
      store(to[3 * window + 2] + c, square);
    };
    widenColumns<1, 1>(middle, c, sum, up, square);
    keep(0);
    widenColumns<2, 2>(middle, c, sum, up, square);
    keep(1);
    widenColumns<3, 3>(middle, c, sum, up, square);
    keep(2);
    widenColumns<4, 5>(middle, c, sum, up, square);
    keep(3);
  }
}

template <int h>
FETTLE_INLINE void fitRow(const double* sum, const double* up, const double* square, const double* count,
                          int n, double most, double* __restrict weight, double* __restrict height,
                          double* __restrict along, double* __restrict across) noexcept {
  constexpr double kCount = (2.0 * h + 1.0) * (2.0 * h + 1.0);
  constexpr double kPerSpread = 3.0 / (kCount * h * (h + 1.0));
  for (int c = 0; c < n; c += 8) {
    Doubles z = load<Doubles>(sum + c), x{}, y = load<Doubles>(up + c), zz = load<Doubles>(square + c);
    for (int k = 1; k <= h; ++k) {
      const Doubles right = load<Doubles>(sum + c + k), left = load<Doubles>(sum + c - k);
      z += left + right;
      x += spread(k) * (right - left);
      y += load<Doubles>(up + c - k) + load<Doubles>(up + c + k);
      zz += load<Doubles>(square + c - k) + load<Doubles>(square + c + k);
    }
    const Doubles mean = z * spread(1.0 / kCount);
    const Doubles rest = zz - z * mean - (x * x + y * y) * spread(kPerSpread);
    const Doubles none{}, w = rest <= spread(most) ? load<Doubles>(count + c) : none;
    store(weight + c, w);
    store(height + c, w * mean);
    store(along + c, w * (x * spread(kPerSpread)));
    store(across + c, w * (y * spread(kPerSpread)));
  }
}

// The planes of the windows of half-width h around each column of a row, by the sums of its columns: height at the
// middle and slopes, times `count`, where it leaves no more than `most`, else 0. `count` is the window's number of
// samples, 0 where it is not whole.
void fitWindows(int h, const double* sum, const double* up, const double* square, const double* count, int n,
                double most, double* weight, double* height, double* along, double* across) noexcept {
  const auto fit = [&]<int kHalf>() {
    fitRow<kHalf>(sum, up, square, count, n, most, weight, height, along, across);
  };
  if (h == 1) return fit.template operator()<1>();
  if (h == 2) return fit.template operator()<2>();
  if (h == 3) return fit.template operator()<3>();
  fit.template operator()<5>();
}

// Adds to what the larger windows say of each column of a row what those of half-width h do whose middles lie up to h
// rows away: weight, height in that row, slope along it. middle[k] is row k from there, its four figures of this window
// `stride` elements apart.
template <int h>
FETTLE_INLINE void gatherWindow(const double* const* middle, std::ptrdiff_t stride, int c, Doubles& weights,
                                Doubles& heights, Doubles& slopes) noexcept {
  const auto at = [&](int k, int figure) { return load<Doubles>(middle[k] + figure * stride + c); };
  weights += at(0, 0);
  heights += at(0, 1);
  slopes += at(0, 2);
  for (int k = 1; k <= h; ++k) {
    weights += at(-k, 0) + at(k, 0);
    heights += (at(-k, 1) + at(k, 1)) + spread(k) * (at(-k, 3) - at(k, 3));
    slopes += at(-k, 2) + at(k, 2);
  }
}

// Of each column what the windows say that reach 5, 3, 2 and 1 columns from it or more: weight, height and slope.
// to[3 * window + figure]; the four windows of a row are 4 * stride elements apart.
void gatherColumns(const double* const* middle, std::ptrdiff_t stride, int n, double* const* to) noexcept {
  const double* rows[4][11];
  for (int window = 0; window < 4; ++window)
    for (int k = -5; k <= 5; ++k) rows[window][k + 5] = middle[k] + 4 * window * stride;
  for (int c = 0; c < n; c += 8) {
    Doubles weights{}, heights{}, slopes{};
    const auto keep = [&](int window) {
      store(to[3 * window] + c, weights);
      store(to[3 * window + 1] + c, heights);
      store(to[3 * window + 2] + c, slopes);
    };
    gatherWindow<5>(rows[3] + 5, stride, c, weights, heights, slopes);
    keep(3);
    gatherWindow<3>(rows[2] + 5, stride, c, weights, heights, slopes);
    keep(2);
    gatherWindow<2>(rows[1] + 5, stride, c, weights, heights, slopes);
    keep(1);
    gatherWindow<1>(rows[0] + 5, stride, c, weights, heights, slopes);
    keep(0);
  }
}

// The results of a row: the mean of what all windows that cover a sample say of it, through the difference to its
// height, which is of the order of the noise.
void writeRow(const double* const* from, const double* in_noises, const float* z, int n, double noise,
              float* __restrict out) noexcept {
  // By distance from the sample: the smallest window that reaches it.
  constexpr int kWindowAt[] = {0, 0, 1, 2, 3, 3};
  for (int c = 0; c < n; c += 8) {
    Doubles weight = load<Doubles>(from[0] + c), total = load<Doubles>(from[1] + c);
    for (int k = 1; k <= 5; ++k) {
      const double* const* window = from + 3 * kWindowAt[k];
      weight += load<Doubles>(window[0] + c - k) + load<Doubles>(window[0] + c + k);
      total += (load<Doubles>(window[1] + c - k) + load<Doubles>(window[1] + c + k)) +
               spread(k) * (load<Doubles>(window[2] + c - k) - load<Doubles>(window[2] + c + k));
    }
    const Doubles none{};
    const Doubles change = weight > none ? total / weight - load<Doubles>(in_noises + c) : none;
    store(out + c, narrowed(widened(load<HalfFloats>(z + c)) + spread(noise) * change));
  }
}
