// The kernels of total_variation.cpp; see kernel.h.

// Differences to the next column and the next row in thetas; NaN where one of the two is missing.
void differences(const float* row, const float* next, double per_theta, int n, float* __restrict along,
                 float* __restrict across) noexcept {
  for (int c = 0; c < n; ++c) {
    const double here = static_cast<double>(row[c]);
    const double a = (static_cast<double>(row[c + 1]) - here) * per_theta;
    const double b = (static_cast<double>(next[c]) - here) * per_theta;
    // Shortened together, so that the direction stays.
    const double la = std::fabs(a), lb = std::fabs(b);
    double most = la > kSteepest ? la : kSteepest;  // not a number: the bound
    most = lb > most ? lb : most;
    const double shorter = kSteepest / most;
    along[c] = static_cast<float>(a * shorter);
    across[c] = static_cast<float>(b * shorter);
  }
}

// div p over a row; along[-1] is 0.
void divergence(const float* along, const float* across, const float* across_before, int n,
                float* __restrict out) noexcept {
  for (int c = 0; c < n; ++c) out[c] = (along[c] - along[c - 1]) + (across[c] - across_before[c]);
}

// One step of one row of p.
void climb(const float* __restrict slope_along, const float* __restrict slope_across,
           const float* __restrict here, const float* __restrict next, int n, float* __restrict along,
           float* __restrict across) noexcept {
  for (int c = 0; c < n; ++c) {
    float a = along[c] + kStep * ((here[c + 1] - here[c]) + slope_along[c]);
    float b = across[c] + kStep * ((next[c] - here[c]) + slope_across[c]);
    a = a == a ? a : 0.0F;  // no neighbour, nothing flows
    b = b == b ? b : 0.0F;
    const float square = a * a + b * b;
    const float length = std::sqrt(square > 1.0F ? square : 1.0F);
    along[c] = a / length;
    across[c] = b / length;
  }
}

void moveRow(const float* heights, const float* __restrict divergence, double theta, int n,
             float* __restrict out) noexcept {
  for (int c = 0; c < n; ++c)
    out[c] = static_cast<float>(static_cast<double>(heights[c]) + theta * static_cast<double>(divergence[c]));
}
