// Counts over a window of outliers; see each_cpu-inl.h.

/// Adds to counts what one row of windows holds, for `chunks` of kLanes outputs: samples of it that exist, and of these how
/// many lie more than `range` below and above the centre. `row` points to the sample in the column of the first output.
void countRow(const float* centre, const float* row, int radius, float range, int chunks, std::int32_t* there,
              std::int32_t* below, std::int32_t* above) noexcept {
  for (int chunk = 0; chunk < chunks; ++chunk) {
    for (int c = chunk * kLanes; c < (chunk + 1) * kLanes; c += kFloatPack) {
      const FloatPack z = load<FloatPack>(centre + c);
      IntPack n = load<IntPack>(there + c), under = load<IntPack>(below + c), over = load<IntPack>(above + c);
      for (int dx = -radius; dx <= radius; ++dx) {
        const FloatPack s = load<FloatPack>(row + c + dx);
        // True is -1; what does not exist compares false.
        n -= s == s;
        under -= z - s > range;
        over -= s - z > range;
      }
      store(there + c, n);
      store(below + c, under);
      store(above + c, over);
    }
  }
}
