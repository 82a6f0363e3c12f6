// What may hold a contact for any centre near one place.

// The least of `slope` * mz for mz between mz_low and mz_high, both >= 0; slope is linear between its values at
// the ends of a part of an edge.
inline void leastLead(const Lanes& slope0, const Lanes& slope1, const Lanes& mz_low, const Lanes& mz_high,
                      Lanes& least) noexcept {
  Lanes slope = slope0;
  smaller(slope, slope1);
  least = slope * mz_high;
  smaller(least, slope * mz_low);
}

// An edge from z0 to z1 along an axis with spacing s, `q` the centre from its first sample along it, `m` from
// its line across it in the plane. `before0`, `before1`: the samples next to it on the side where `m` is
// negative, `after` on the other; `s_across` their distance.
inline void mayTouchEdge(const Lanes& q, const Lanes& qz, const Lanes& m, const Lanes& z0, const Lanes& z1,
                         const Lanes& before0, const Lanes& before1, const Lanes& after0, const Lanes& after1,
                         double s, double s_across, double reach2, double seam, double room,
                         LaneMask& may) noexcept {
  const Lanes zero{};
  const Lanes one = zero + 1.0;
  const Lanes ez = z1 - z0;
  const Lanes ahead = q * s + qz * ez;
  const Lanes length2 = s * s + ez * ez;
  Lanes width = ez;
  absolute(width);
  width = (width + s) * room;
  const Lanes t = ahead / length2;
  const Lanes dt = width / length2;
  Lanes t0 = t - dt;
  larger(t0, zero);
  smaller(t0, one);
  Lanes t1 = t + dt;
  larger(t1, zero);
  smaller(t1, one);
  Lanes foot = t;
  larger(foot, zero);
  smaller(foot, one);
  // The part of the centre's way from the line that is across it changes by no more than the centre itself.
  const Lanes along = q - foot * s;
  const Lanes up = qz - foot * ez;
  const Lanes mz = qz - t * ez;
  Lanes mz_low = mz - room;
  larger(mz_low, zero);
  const Lanes mz_high = mz + room;
  const Lanes here0 = z0 + t0 * ez;
  const Lanes here1 = z0 + t1 * ez;
  Lanes before, after;
  leastLead(before0 + t0 * (before1 - before0) - here0, before0 + t1 * (before1 - before0) - here1, mz_low,
            mz_high, before);
  leastLead(after0 + t0 * (after1 - after0) - here0, after0 + t1 * (after1 - after0) - here1, mz_low, mz_high,
            after);
  may = (ahead > -width) & (ahead < length2 + width) & (along * along + m * m + up * up < reach2) &
        (mz_high >= zero) & (before <= (m + room) * s_across + seam) &
        (after <= seam - (m - room) * s_across);
}

// The features of the cells of one register that may hold a contact for a centre within `room` of the ball's,
// whose reach is longer by as much.
inline void mayTouch(const LaneWindow& w, const LaneProbe& ball, double room, const LaneCell* cells,
                     int count, unsigned* features) noexcept {
  Around a;
  gather(w, ball, cells, count, a);
  const Lanes zero{};
  unsigned samples;
  {
    const Lanes mz = ball.z - a.z11;
    const Lanes d2 = a.mx1 * a.mx1 + a.my1 * a.my1 + mz * mz;
    const Lanes along_x = a.mx1 * w.sx;
    const Lanes along_y = a.my1 * w.sy;
    const auto leads = [&](const Lanes& rise, const Lanes& along, double s, LaneMask& may) {
      Lanes size = rise;
      absolute(size);
      may &= mz * rise <= along + (size + s) * room;
    };
    LaneMask may = (d2 < ball.reach2) & (mz >= zero - room);
    leads(a.z01 - a.z11, along_x + ball.seam_x, w.sx, may);
    leads(a.z21 - a.z11, ball.seam_x - along_x, w.sx, may);
    leads(a.z10 - a.z11, along_y + ball.seam_y, w.sy, may);
    leads(a.z12 - a.z11, ball.seam_y - along_y, w.sy, may);
    samples = bits(may);
  }
  LaneMask may;
  mayTouchEdge(a.mx0, ball.z - a.z01, a.my1, a.z01, a.z11, a.z00, a.z10, a.z02, a.z12, w.sx, w.sy,
               ball.reach2, ball.seam_y, room, may);
  const unsigned edges_x = bits(may);
  mayTouchEdge(a.my0, ball.z - a.z10, a.mx1, a.z10, a.z11, a.z00, a.z01, a.z20, a.z21, w.sy, w.sx,
               ball.reach2, ball.seam_x, room, may);
  const unsigned edges_y = bits(may);

  Lanes low = a.z00;
  Lanes high = a.z00;
  larger(high, a.z10);
  larger(high, a.z01);
  larger(high, a.z11);
  smaller(low, a.z10);
  smaller(low, a.z01);
  smaller(low, a.z11);
  const Lanes b = a.z10 - a.z00;
  const Lanes c = a.z01 - a.z00;
  const Lanes d = (a.z11 - a.z01) - b;
  Lanes above = ball.z - high - room;
  larger(above, zero);
  const Lanes above_most = ball.z - low + room;
  may = above_most > zero;
  crosses(b, d, a.mx0, w.sx, above, above_most, room, may);
  crosses(c, d, a.my0, w.sy, above, above_most, room, may);
  // The ball bridges a cell, as in lookInside.
  Lanes p = b;
  absolute(p);
  Lanes p1 = b + d;
  absolute(p1);
  larger(p, p1);
  Lanes q = c;
  absolute(q);
  Lanes q1 = c + d;
  absolute(q1);
  larger(q, q1);
  Lanes twist = d;
  absolute(twist);
  const Lanes bridge = twist * above - p * q;
  may &=
      ~((bridge > zero) & (bridge * bridge > (w.sx * w.sx + p * p) * (w.sy * w.sy + q * q) * (1.0 + 1e-9)));
  const unsigned insides = bits(may);
  static_assert(kSampleFeature == 1 && kEdgeXFeature == 2 && kEdgeYFeature == 4 && kInsideFeature == 8);
  for (int k = 0; k < kWidth; ++k)
    features[k] =
        (samples >> k & 1u) | (edges_x >> k & 1u) << 1 | (edges_y >> k & 1u) << 2 | (insides >> k & 1u) << 3;
}

inline bool candidates(const LaneWindow& w, const LaneBounds& bounds, const LaneProbe& ball, double room,
                       std::int32_t i0, std::int32_t i1, std::int32_t j0, std::int32_t j1,
                       LaneCandidates& out) noexcept {
  LaneCell cells[kMostLaneCells];
  const int count = reached(w, bounds, ball, i0, i1, j0, j1, cells);
  out.count = 0;
  out.insides = 0;
  for (int at = 0; at < count; at += kWidth) {
    const int some = count - at < kWidth ? count - at : kWidth;
    unsigned features[kWidth];
    LaneCell looked[kWidth];
    bool rim[kWidth] = {};
    int plain = -1;
    for (int k = 0; k < some; ++k) {
      looked[k] = cells[at + k];
      rim[k] = bounds.rim[static_cast<std::size_t>(looked[k].j * w.columns + looked[k].i)] != 0;
      if (!rim[k]) plain = k;
    }
    if (plain >= 0) {
      for (int k = 0; k < some; ++k)
        if (rim[k]) looked[k] = looked[plain];
      mayTouch(w, ball, room, looked, some, features);
    }
    for (int k = 0; k < some; ++k) {
      const LaneCell cell = cells[at + k];
      if (rim[k]) features[k] = kRimFeature;
      if (features[k] == 0) continue;
      if (out.count == LaneCandidates::kMost) return false;
      out.cells[static_cast<std::size_t>(out.count++)] = {cell.i, cell.j,
                                                          static_cast<std::uint16_t>(features[k])};
      if ((features[k] & kInsideFeature) == 0) continue;
      const double* z = w.z + cell.j * w.columns + cell.i;
      const double z00 = z[0], z10 = z[1], z01 = z[w.columns], z11 = z[w.columns + 1];
      const auto n = static_cast<std::size_t>(out.insides++);
      out.z00[n] = z00;
      out.b[n] = z10 - z00;
      out.c[n] = z01 - z00;
      out.d[n] = (z11 - z01) - (z10 - z00);
      out.low[n] = std::min(std::min(z00, z10), std::min(z01, z11));
      out.high[n] = std::max(std::max(z00, z10), std::max(z01, z11));
      out.x0[n] = (w.column + cell.i) * w.sx;
      out.y0[n] = (w.row + cell.j) * w.sy;
    }
  }
  return true;
}
