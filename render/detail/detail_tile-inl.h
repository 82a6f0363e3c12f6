// The kernels of detail_tile.cpp; see kernel.h.

// `rows` rows of samples, row r at v[r] of the coarse row's height, 0 .. 1. Comparisons with NaN are false:
// holes change nothing.
void addRows(const float* __restrict z, int rows, const float* v_of, const CoarseRow& coarse,
             const float* __restrict u, float* __restrict deviation) {
  const float* __restrict low_left = coarse.low_left;
  const float* __restrict left_rise = coarse.left_rise;
  const float* __restrict top_right = coarse.top_right;
  const float* __restrict right_fall = coarse.right_fall;
  for (int r = 0; r < rows; ++r, z += kTileStride) {
    const float v = v_of[r], w = 1.0F - v;
    for (int c = 0; c < kColumns; ++c) {
      // Selected before the arithmetic: arithmetic under a condition is not vectorised.
      const bool lower = u[c] <= w;
      const float base = lower ? low_left[c] : top_right[c];
      const float slope = lower ? left_rise[c] : right_fall[c];
      const float d = std::fabs(z[c] - (base + (lower ? v : w) * slope));
      deviation[c] = d > deviation[c] ? d : deviation[c];
    }
  }
}

// Over three rows of samples, at each column; `most` grows to the largest magnitude.
void extremesOfRows(const float* first, const float* second, const float* third, float* __restrict lowest,
                    float* __restrict highest, float* __restrict hole, float* __restrict most) {
  for (int c = 0; c < kColumns; ++c) {
    const float a = first[c], b = second[c], d = third[c];
    float low = kInfiniteError, high = -kInfiniteError, any = 0.0F;
    low = a < low ? a : low;
    low = b < low ? b : low;
    low = d < low ? d : low;
    high = a > high ? a : high;
    high = b > high ? b : high;
    high = d > high ? d : high;
    any = a == a ? any : 1.0F;
    any = b == b ? any : 1.0F;
    any = d == d ? any : 1.0F;
    lowest[c] = low;
    highest[c] = high;
    hole[c] = any;
    // Where all are holes both are infinite, of opposite signs.
    const float up = high >= low && high > most[c] ? high : most[c];
    most[c] = high >= low && -low > up ? -low : up;
  }
}

// How far the samples of the cells of one row reach beyond their vertices.
void excessOfRow(const float* __restrict below, const float* __restrict above, const float* __restrict lowest,
                 const float* __restrict highest, const float* __restrict hole, int cells,
                 float* __restrict excess) {
  for (int i = 0; i < cells; ++i) {
    const float left_low = above[i] < below[i] ? above[i] : below[i];
    const float right_low = above[i + 1] < below[i + 1] ? above[i + 1] : below[i + 1];
    const float left_high = above[i] > below[i] ? above[i] : below[i];
    const float right_high = above[i + 1] > below[i + 1] ? above[i + 1] : below[i + 1];
    const float under = (right_low < left_low ? right_low : left_low) - lowest[i];
    const float over = highest[i] - (right_high > left_high ? right_high : left_high);
    const float most = under > over ? under : over;
    // Where there are only holes nothing is drawn: both are -infinity.
    const float holed = lowest[i] <= highest[i] ? kInfiniteError : most;
    excess[i] = hole[i] > 0.0F ? holed : most;
  }
}
