// Sums of a bilateral window; see each_cpu-inl.h.

/// Weights and weighted differences of two samples opposite each other across each centre.
FETTLE_INLINE void addOpposites(const FloatPack& one, const FloatPack& other, const FloatPack& centre,
                                float per_range, float weight, FloatPack& sum,
                                FloatPack& sum_weight) noexcept {
  const FloatPack beyond = FloatPack{} + kBeyond, none{};
  // A hole compares false and goes beyond the weights, like a difference that overflows.
  const FloatPack a = greater(lesser((one - centre) * per_range, beyond), -beyond);
  const FloatPack b = greater(lesser((other - centre) * per_range, beyond), -beyond);
  FloatPack wa = greater(1.0F - a * a * 0.03125F, none);
  FloatPack wb = greater(1.0F - b * b * 0.03125F, none);
  for (int twice = 0; twice < 4; ++twice) {
    wa *= wa;
    wb *= wb;
  }
  sum += weight * (wa * a + wb * b);
  sum_weight += weight * (wa + wb);
}

/// Adds to sums of weight times difference [range sigmas] and of weight what one pair of window rows holds,
/// for `chunks` of kChunk outputs, from left to right for each. `above` and `below` point to the samples over
/// and under the first output; first_dx is 1 for the centre's own row, which is both.
void addRows(const float* centre, const float* above, const float* below, const float* weights, int first_dx,
             int radius, float per_range, int chunks, double* sum, double* sum_weight) noexcept {
  for (int c = 0; c < chunks * kChunk; c += 2 * kFloatPack) {
    const FloatPack z0 = load<FloatPack>(centre + c), z1 = load<FloatPack>(centre + c + kFloatPack);
    FloatPack s0{}, s1{}, w0{}, w1{};
    for (int dx = first_dx; dx <= radius; ++dx) {
      const float* one = above + c + dx;
      const float* other = below + c - dx;
      addOpposites(load<FloatPack>(one), load<FloatPack>(other), z0, per_range, weights[dx], s0, w0);
      addOpposites(load<FloatPack>(one + kFloatPack), load<FloatPack>(other + kFloatPack), z1, per_range,
                   weights[dx], s1, w1);
    }
    for (int half = 0; half < 4; ++half) {
      const int at = c + half * kPack;
      const FloatPack& s = half < 2 ? s0 : s1;
      const FloatPack& w = half < 2 ? w0 : w1;
      store(sum + at, load<Pack>(sum + at) + widenedHalf(s, half % 2));
      store(sum_weight + at, load<Pack>(sum_weight + at) + widenedHalf(w, half % 2));
    }
  }
}

void finishRow(const float* centre, const double* __restrict sum, const double* __restrict sum_weight,
               double range, int n, float* __restrict out) noexcept {
  for (int i = 0; i < n; ++i)
    out[i] = static_cast<float>(static_cast<double>(centre[i]) + range * (sum[i] / sum_weight[i]));
}
