// Which cells of a window the ball may reach, by bounds prepared once.

inline void prepare(const LaneWindow& w, std::int32_t rows, double more_mm, LaneBounds& bounds) noexcept {
  Lanes count;
  numbered(count);
  const double per_x = 0.5 / w.sx;
  const double per_y = 0.5 / w.sy;
  for (std::int32_t j = 0; j + 1 < rows; ++j) {
    const double y = (j + 0.5) * w.sy;
    for (std::int32_t i = 0; i < w.columns; i += kWidth) {
      const std::int32_t k = j * w.columns + i;
      const double* z = w.z + k;
      Lanes z00, z10, z01, z11;
      load(z00, z);
      load(z10, z + 1);
      load(z01, z + w.columns);
      load(z11, z + w.columns + 1);
      Lanes top = z00;
      larger(top, z10);
      larger(top, z01);
      larger(top, z11);
      // The patch differs from its middle plane by at most a quarter of its twist.
      const Lanes p = per_x * (z10 - z00 + z11 - z01);
      const Lanes q = per_y * (z01 - z00 + z11 - z10);
      Lanes d = z11 - z10 - z01 + z00;
      absolute(d);
      const Lanes middle = 0.25 * (z00 + z10 + z01 + z11);
      Lanes nz = 1.0 + p * p + q * q;
      squareRoot(nz);
      nz = 1.0 / nz;
      const Lanes nx = -p * nz;
      const Lanes ny = -q * nz;
      const Lanes x = (count + (i + 0.5)) * w.sx;
      store(bounds.top.data() + k, top);
      store(bounds.nx.data() + k, nx);
      store(bounds.ny.data() + k, ny);
      store(bounds.nz.data() + k, nz);
      store(bounds.offset.data() + k, -(nx * x + ny * y + nz * middle));
      store(bounds.margin.data() + k, 0.25 * d * nz + more_mm);
    }
  }
}

// The lanes in a mask, and then the first.
struct LanesOf {
  std::int16_t lane[kWidth];
  std::int16_t count;
};
inline constexpr auto kLanesOf = [] {
  std::array<LanesOf, 1u << kWidth> all{};
  for (unsigned mask = 0; mask <= kAllLanes; ++mask)
    for (int l = 0; l < kWidth; ++l)
      if ((mask >> l & 1u) != 0) all[mask].lane[all[mask].count++] = static_cast<std::int16_t>(l);
  return all;
}();

inline int reached(const LaneWindow& w, const LaneBounds& bounds, const LaneProbe& ball, std::int32_t i0,
                   std::int32_t i1, std::int32_t j0, std::int32_t j1, LaneCell* out) noexcept {
  const Lanes zero{};
  Lanes count;
  numbered(count);
  const double from_x = ball.x - w.column * w.sx;
  const double from_y = ball.y - w.row * w.sy;
  // Nothing here decides about a contact, so everything has room for roundings.
  const double reach = ball.reach * (1.0 + 1e-6);
  const double reach2 = ball.reach2 * (1.0 + 1e-6);
  // Squared distance along x of the columns that all rows share.
  constexpr int kMostChunks = 48 / kWidth;
  Lanes dx2[kMostChunks];
  int chunks = 0;
  for (std::int32_t i = i0; i <= i1 && chunks < kMostChunks; i += kWidth) {
    const Lanes x = (count + static_cast<double>(i)) * w.sx;
    Lanes dx = x - from_x;
    larger(dx, from_x - w.sx - x);
    larger(dx, zero);
    dx2[chunks++] = dx * dx;
  }
  int n = 0;
  for (std::int32_t j = j0; j <= j1; ++j) {
    const double below = j * w.sy - from_y;
    const double above = from_y - (j + 1) * w.sy;
    const double dy = below > 0.0 ? below : (above > 0.0 ? above : 0.0);
    const double left = reach2 - dy * dy;
    if (!(left > 0.0)) continue;
    for (int c = 0; c < chunks; ++c) {
      const std::int32_t i = i0 + c * kWidth;
      const std::int32_t k = j * w.columns + i;
      Lanes top;
      load(top, bounds.top.data() + k);
      Lanes gap = ball.z - top;
      larger(gap, zero);
      const unsigned lanes = i1 - i >= kWidth ? kAllLanes : (1u << (i1 - i + 1)) - 1u;
      const unsigned near = bits(gap * gap + dx2[c] < left) & lanes;
      if (near == 0) continue;
      Lanes nx, ny, nz, offset, margin;
      load(nx, bounds.nx.data() + k);
      load(ny, bounds.ny.data() + k);
      load(nz, bounds.nz.data() + k);
      load(offset, bounds.offset.data() + k);
      load(margin, bounds.margin.data() + k);
      Lanes over = nx * from_x + ny * from_y + (nz * ball.z + offset);
      absolute(over);
      // All lanes are written, those in the mask first, and only those counted: no branch that cannot be predicted.
      const LanesOf& those = kLanesOf[bits(over - margin < reach) & near];
      for (int l = 0; l < kWidth; ++l)
        out[n + l] = {static_cast<std::int16_t>(i + those.lane[l]), static_cast<std::int16_t>(j)};
      n += those.count;
    }
  }
  return n;
}
