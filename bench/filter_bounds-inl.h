// The kernels of filter_bounds.cpp; see each_cpu-inl.h. Eight chains at once, more than the latency of an instruction hides; in registers
// where there are 32 of them, with AVX-512: with AVX2 some are spilled, and the bound is too slow.

double productsAlone(int rounds) noexcept {
  Doubles v[8];
  for (int i = 0; i < 8; ++i) v[i] = spread(0.1 * i);
  const Doubles a = spread(0.5), b = spread(0.25);
  for (int k = 0; k < rounds; ++k)
#pragma GCC unroll 8
    for (int i = 0; i < 8; ++i) v[i] = fused(v[i], a, b);
  double sum = 0.0;
  for (const Doubles& each : v) sum += each[0];
  return sum;
}

double extremaAlone(int rounds) noexcept {
  Floats v[8];
  for (int i = 0; i < 8; ++i) v[i] = Floats{} + 0.1F * static_cast<float>(i);
  Floats low = Floats{} + 0.2F, high = Floats{} + 0.4F;
  for (int k = 0; k < rounds; k += 2)
#pragma GCC unroll 8
    for (int i = 0; i < 8; ++i)
#if FETTLE_LEVEL == 2
      v[i] =
          _mm512_max_ps(_mm512_min_ps(v[i], high), low);  // left to itself the compiler compares and chooses
#else
      v[i] = greater(lesser(v[i], high), low);
#endif
  double sum = 0.0;
  for (const Floats& each : v) sum += each[0];
  return sum;
}
