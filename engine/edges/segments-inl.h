// Part of across.cpp, once for each CpuLevel: see engine/simd/kernel.h.

// Residuals of the planes between edge `low` and each edge from `first` on, times `weight`. `sums` as
// AcrossSearch::sums_. The same formulas as fitPlane(), without branches, so that the compiler
// vectorises them.
void fitFrom(const double* const* sums, std::size_t low, std::size_t first, std::size_t end, double weight,
             float* __restrict residuals) noexcept {
  const double* __restrict n = sums[0], * __restrict d = sums[1], * __restrict s = sums[2];
  const double* __restrict dd = sums[3], * __restrict ds = sums[4], * __restrict ss = sums[5];
  const double* __restrict z = sums[6], * __restrict zd = sums[7], * __restrict zs = sums[8];
  const double* __restrict zz = sums[9];
  const double n0 = n[low], d0 = d[low], s0 = s[low], dd0 = dd[low], ds0 = ds[low], ss0 = ss[low];
  const double z0 = z[low], zd0 = zd[low], zs0 = zs[low], zz0 = zz[low];
  for (std::size_t b = first; b < end; ++b) {
    const double count = n[b] - n0;
    const double share = 1.0 / (count > 0.5 ? count : 1.0);
    const double mean_d = (d[b] - d0) * share, mean_s = (s[b] - s0) * share, sum_z = z[b] - z0;
    const double squares_d = dd[b] - dd0 - (d[b] - d0) * mean_d + kLevelling;
    const double squares_s = ss[b] - ss0 - (s[b] - s0) * mean_s + kLevelling;
    const double product = ds[b] - ds0 - (d[b] - d0) * mean_s;
    const double lean_d = zd[b] - zd0 - sum_z * mean_d;
    const double lean_s = zs[b] - zs0 - sum_z * mean_s;
    const double level = zz[b] - zz0 - sum_z * sum_z * share;
    const double explained =
        (lean_d * lean_d * squares_s - 2.0 * lean_d * lean_s * product + lean_s * lean_s * squares_d) /
        (squares_d * squares_s - product * product);
    const double residual = level - (count > kLeastForPlane ? explained : 0.0);
    residuals[b] = static_cast<float>((residual > 0.0 ? residual : 0.0) * weight);
  }
}
