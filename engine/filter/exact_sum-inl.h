// The kernel of exact_sum.cpp; see kernel.h.

// How many samples one lane (or two) cannot hold.
int misfits(const float* row, int n, double cut0, double cut1, int lanes) noexcept {
  int wrong = 0;
  if (lanes == 1) {
    for (int i = 0; i < n; ++i) {
      const double x = row[i] == row[i] ? static_cast<double>(row[i]) : 0.0;
      wrong += (x + cut0) - cut0 != x ? 1 : 0;
    }
  } else {
    for (int i = 0; i < n; ++i) {
      const double x = row[i] == row[i] ? static_cast<double>(row[i]) : 0.0;
      const double rest = x - ((x + cut0) - cut0);
      wrong += (rest + cut1) - cut1 != rest ? 1 : 0;
    }
  }
  return wrong;
}
