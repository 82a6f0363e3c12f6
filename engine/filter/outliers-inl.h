// Counts over a window of outliers; see each_cpu-inl.h.

/// Adds to counts what one row of windows holds, for `chunks` of kLanes outputs: samples of it that exist, and of these how
/// many lie more than `range` below and above the centre. `row` points to the sample in the column of the first output.
void countRow(const float* centre, const float* row, int radius, float range, int chunks, std::int32_t* there,
              std::int32_t* below, std::int32_t* above) noexcept {
  for (int chunk = 0; chunk < chunks; ++chunk) {
    const int c = chunk * kLanes;
    const Floats z = load<Floats>(centre + c);
    Ints n = load<Ints>(there + c), under = load<Ints>(below + c), over = load<Ints>(above + c);
    for (int dx = -radius; dx <= radius; ++dx) {
      const Floats s = load<Floats>(row + c + dx);
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
