// The kernels of planes.cpp; see kernel.h.

// Of each column of 2 h + 1 rows from rows[0] on: the sum of z, of z times its row from the middle, and of z squared.
void sumColumns(const double* const* rows, int h, int n, double* __restrict sum, double* __restrict up,
                double* __restrict square) noexcept {
  for (int c = 0; c < n; ++c) sum[c] = up[c] = square[c] = 0.0;
  for (int k = -h; k <= h; ++k) {
    const double* z = rows[k + h];
    const double at = k;
    for (int c = 0; c < n; ++c) {
      sum[c] += z[c];
      up[c] += at * z[c];
      square[c] += z[c] * z[c];
    }
  }
}

// The planes of the windows around columns h .. n - h - 1 of a row, by the sums of its columns: height at the middle and
// slopes, times the window's samples where it leaves no more than `most`, else 0. `whole` is 1 where nothing is missing.
void fitWindows(const double* sum, const double* up, const double* square, const double* whole, int h, int n,
                double most, double* __restrict weight, double* __restrict height, double* __restrict along,
                double* __restrict across) noexcept {
  const double count = (2.0 * h + 1.0) * (2.0 * h + 1.0);
  const double spread = count * h * (h + 1.0) / 3.0;
  for (int c = h; c < n - h; ++c) {
    double z = 0.0, x = 0.0, y = 0.0, zz = 0.0;
    for (int k = -h; k <= h; ++k) {
      z += sum[c + k];
      x += k * sum[c + k];
      y += up[c + k];
      zz += square[c + k];
    }
    const double rest = zz - z * z / count - (x * x + y * y) / spread;
    const double w = rest <= most ? count * whole[c] : 0.0;
    weight[c] = w;
    height[c] = w * (z / count);
    along[c] = w * (x / spread);
    across[c] = w * (y / spread);
  }
}

// Of each column of the windows' planes around a row, 2 h + 1 rows of them: weight, their heights in that row, and their
// slopes along it.
void gatherColumns(const double* const* weight, const double* const* height, const double* const* along,
                   const double* const* across, int h, int n, double* __restrict weights,
                   double* __restrict heights, double* __restrict slopes) noexcept {
  for (int c = 0; c < n; ++c) weights[c] = heights[c] = slopes[c] = 0.0;
  for (int k = -h; k <= h; ++k) {
    const double *w = weight[k + h], *z = height[k + h], *x = along[k + h], *y = across[k + h];
    const double from = -k;  // of this row, from the window's middle
    for (int c = 0; c < n; ++c) {
      weights[c] += w[c];
      heights[c] += z[c] + from * y[c];
      slopes[c] += x[c];
    }
  }
}

// Adds what all windows that cover a sample of the row say of it.
void gatherRow(const double* weights, const double* heights, const double* slopes, int h, int n,
               double* __restrict total_weight, double* __restrict total) noexcept {
  for (int k = -h; k <= h; ++k) {
    const double from = -k;
    for (int c = h; c < n - h; ++c) {
      total_weight[c] += weights[c + k];
      total[c] += heights[c + k] + from * slopes[c + k];
    }
  }
}
