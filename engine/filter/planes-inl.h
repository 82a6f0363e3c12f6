// The kernels of planes.cpp; see kernel.h. Rows of doubles begin at a first column that is readable 8 elements to its
// left and are read and written in registers: 16 elements beyond the last column are readable and finite.

// Heights of a row above a reference, in noises; holes are 0. n rounded up to kPack.
void heightsInNoises(const float* z, int n, double reference, double per_noise, double tallest,
                     double* __restrict out) noexcept {
  const Pack least = every(-tallest), most = every(tallest), none{};
  for (int c = 0; c < n; c += kPack) {
    const Pack wide = widened(load<HalfPack>(z + c));
    const Pack above = (wide - every(reference)) * every(per_noise);
    store(out + c, wide == wide ? lesser(greater(above, least), most) : none);
  }
}

// What the window of half-width h adds to the sums of its columns beyond the next smaller window.
template <int kFrom, int kTo>
FETTLE_INLINE void widenColumns(const double* const* middle, int c, Pack& sum, Pack& up,
                                Pack& square) noexcept {
  for (int k = kFrom; k <= kTo; ++k) {
    const Pack above = load<Pack>(middle[k] + c), below = load<Pack>(middle[-k] + c);
    sum += above + below;
    up += every(k) * (above - below);
    square += above * above + below * below;
  }
}

// Of each column of the rows around middle[0], for each window: the sum of z, of z times its row from the middle, and of
// z squared. to[3 * window + figure]
void sumColumns(const double* const* middle, int n, double* const* to) noexcept {
  for (int c = 0; c < n; c += kPack) {
    const Pack z = load<Pack>(middle[0] + c);
    Pack sum = z, up{}, square = z * z;
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
  for (int c = 0; c < n; c += kPack) {
    Pack z = load<Pack>(sum + c), x{}, y = load<Pack>(up + c), zz = load<Pack>(square + c);
    for (int k = 1; k <= h; ++k) {
      const Pack right = load<Pack>(sum + c + k), left = load<Pack>(sum + c - k);
      z += left + right;
      x += every(k) * (right - left);
      y += load<Pack>(up + c - k) + load<Pack>(up + c + k);
      zz += load<Pack>(square + c - k) + load<Pack>(square + c + k);
    }
    const Pack mean = z * every(1.0 / kCount);
    const Pack rest = zz - z * mean - (x * x + y * y) * every(kPerSpread);
    const Pack none{}, w = rest <= every(most) ? load<Pack>(count + c) : none;
    store(weight + c, w);
    store(height + c, w * mean);
    store(along + c, w * (x * every(kPerSpread)));
    store(across + c, w * (y * every(kPerSpread)));
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
FETTLE_INLINE void gatherWindow(const double* const* middle, std::ptrdiff_t stride, int c, Pack& weights,
                                Pack& heights, Pack& slopes) noexcept {
  const auto at = [&](int k, int figure) { return load<Pack>(middle[k] + figure * stride + c); };
  weights += at(0, 0);
  heights += at(0, 1);
  slopes += at(0, 2);
  for (int k = 1; k <= h; ++k) {
    weights += at(-k, 0) + at(k, 0);
    heights += (at(-k, 1) + at(k, 1)) + every(k) * (at(-k, 3) - at(k, 3));
    slopes += at(-k, 2) + at(k, 2);
  }
}

// Of each column what the windows say that reach 5, 3, 2 and 1 columns from it or more: weight, height and slope.
// to[3 * window + figure]; the four windows of a row are 4 * stride elements apart.
void gatherColumns(const double* const* middle, std::ptrdiff_t stride, int n, double* const* to) noexcept {
  const double* rows[4][11];
  for (int window = 0; window < 4; ++window)
    for (int k = -5; k <= 5; ++k) rows[window][k + 5] = middle[k] + 4 * window * stride;
  for (int c = 0; c < n; c += kPack) {
    Pack weights{}, heights{}, slopes{};
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
  for (int c = 0; c < n; c += kPack) {
    Pack weight = load<Pack>(from[0] + c), total = load<Pack>(from[1] + c);
    for (int k = 1; k <= 5; ++k) {
      const double* const* window = from + 3 * kWindowAt[k];
      weight += load<Pack>(window[0] + c - k) + load<Pack>(window[0] + c + k);
      total += (load<Pack>(window[1] + c - k) + load<Pack>(window[1] + c + k)) +
               every(k) * (load<Pack>(window[2] + c - k) - load<Pack>(window[2] + c + k));
    }
    const Pack none{};
    const Pack change = weight > none ? total / weight - load<Pack>(in_noises + c) : none;
    store(out + c, narrowed(widened(load<HalfPack>(z + c)) + every(noise) * change));
  }
}
