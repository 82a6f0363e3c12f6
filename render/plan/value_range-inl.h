// The kernel of value_range.cpp; see kernel.h.

// Lowest and highest difference of two tiles, in lanes; highest < lowest when there is none. A comparison
// with a hole's NaN is false.
void extremesOf(const float* a, const float* b, double sign_a, double sign_b, double* low, double* high) {
  for (int i = 0; i < engine::kTileSamples; i += kLanes)
    for (int k = 0; k < kLanes; ++k) {
      const double d = sign_a * double{a[i + k]} - sign_b * double{b[i + k]};
      low[k] = d < low[k] ? d : low[k];
      high[k] = d > high[k] ? d : high[k];
    }
}
