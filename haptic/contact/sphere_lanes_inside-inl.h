// Contacts inside cells: minima of the distance along v, of several cells or along one that is twisted.

// A cell's inside along v; see SphereWindow::Collector::inside.
struct Valley {
  Lanes b, c, d, ex, ey, w0;
  double sx, sy;
};

inline void slopeAt(const Valley& f, const Lanes& v, Lanes& slope, Lanes& u, Lanes& height,
                    Lanes& bend) noexcept {
  const Lanes p = f.b + f.d * v;
  const Lanes w = f.w0 + f.c * v;
  const Lanes uu = f.sx * f.sx + p * p;
  u = (f.sx * f.ex - w * p) / uu;
  height = w + p * u;
  const Lanes q = f.c + f.d * u;
  const Lanes uv = p * q + height * f.d;
  bend = f.sy * f.sy + q * q - uv * uv / uu;
  slope = f.sy * (f.sy * v - f.ey) + height * q;
}

// The one minimum between 0 and 1 of the lanes in `lanes`.
inline void minima(const Valley& f, const LaneMask& lanes, unsigned asked, double reach2, const Lanes& start,
                   int at, LaneContacts& out) noexcept {
  const Lanes zero{};
  const Lanes one = zero + 1.0;
  Lanes v = start;
  Lanes low = zero;
  Lanes high = one;
  Lanes slope, u, height, bend;
  LaneMask moving = lanes;
  for (int round = 0; round < 40 && bits(moving) != 0; ++round) {
    slopeAt(f, v, slope, u, height, bend);
    const LaneMask falls = slope < zero;
    low = moving & falls ? v : low;
    high = moving & ~falls ? v : high;
    const Lanes next = bend > zero ? v - slope / bend : zero - 1.0;
    const Lanes to = ((next > low) & (next < high)) ? next : 0.5 * (low + high);
    Lanes moved = to - v;
    absolute(moved);
    v = moving ? to : v;
    moving &= ~(moved < 1e-6);
  }
  slopeAt(f, v, slope, u, height, bend);
  const Lanes mx = f.ex - u * f.sx;
  const Lanes my = f.ey - v * f.sy;
  const Lanes mz = -height;
  const Lanes d2 = mx * mx + my * my + mz * mz;
  const LaneMask found =
      lanes & (u > zero) & (u < one) & (v > zero) & (v < one) & (height < zero) & (d2 < reach2);
  keep(out, at, asked, found, mx, my, mz, d2);
  store(out.u.data() + at, u);
  store(out.v.data() + at, v);
}

// Where the surface's normal goes through the centre, sx (sx u - ex) = -height p and likewise along v; no such
// point when the two sides have no value in common over the whole cell: `slope0` is p or q at one side of the
// cell, `e` the centre from its sample along that axis, -height between `above` and `above_most`. `room`: by
// how much the centre may be elsewhere along the axis.
inline void crosses(const Lanes& slope0, const Lanes& d, const Lanes& e, double s, const Lanes& above,
                    const Lanes& above_most, double room, LaneMask& may) noexcept {
  Lanes p_low = slope0;
  Lanes p_high = slope0 + d;
  const Lanes other = p_high;
  larger(p_high, p_low);
  smaller(p_low, other);
  Lanes most = p_high * above_most;
  larger(most, p_high * above);
  Lanes least = p_low * above_most;
  smaller(least, p_low * above);
  const Lanes at0 = s * e;
  const double margin = 1e-6 * s * s + s * room;  // the first far above rounding
  may &= (most > -at0 - margin) & (least < s * s - at0 + margin);
}

// A cell as its inside needs it: height and slopes as in Patch, and its lowest and highest corner.
struct Facet {
  Lanes z00, b, c, d, low, high;
};

// Minima inside the cells of one register, the centre mx0, my0 from their lower left samples; results go to `at`
// and following.
inline void lookInside(double sx, double sy, const LaneProbe& ball, const Facet& f, const Lanes& mx0,
                       const Lanes& my0, unsigned lanes, int at, LaneFinds& out) noexcept {
  const Lanes zero{};
  const Lanes one = zero + 1.0;
  const Valley valley{f.b, f.c, f.d, mx0, my0, f.z00 - ball.z, sx, sy};
  Lanes above = ball.z - f.high;  // -height, at least and at most
  larger(above, zero);
  const Lanes above_most = ball.z - f.low;
  LaneMask may = above_most > zero;
  crosses(f.b, f.d, mx0, sx, above, above_most, 0.0, may);
  crosses(f.c, f.d, my0, sy, above, above_most, 0.0, may);
  if ((bits(may) & lanes) == 0) return;

  // Second derivatives of the distance, halved: sx^2 + p^2, sy^2 + q^2, p q + z d.
  Lanes p = f.b;
  absolute(p);
  Lanes p1 = f.b + f.d;
  absolute(p1);
  larger(p, p1);
  Lanes q = f.c;
  absolute(q);
  Lanes q1 = f.c + f.d;
  absolute(q1);
  larger(q, q1);
  Lanes twist = f.d;
  absolute(twist);
  Lanes zd = ball.z - f.high;
  const Lanes bridge = twist * above - p * q;
  absolute(zd);
  Lanes below = ball.z - f.low;
  absolute(below);
  larger(zd, below);
  zd = twist * zd;
  const LaneMask convex = zd * (2.0 * p * q + zd) < sx * sx * sy * sy;
  // Twisted so much that the ball bridges it: no minimum inside, only saddles.
  const LaneMask bridged = (bridge > zero) & (bridge * bridge > (sx * sx + p * p) * (sy * sy + q * q));
  out.twisted |= (bits(may & ~convex & ~bridged) & lanes) << at;
  may &= convex;
  if ((bits(may) & lanes) == 0) return;
  Lanes u, height, bend, first, last;
  slopeAt(valley, zero, first, u, height, bend);
  slopeAt(valley, one, last, u, height, bend);
  may &= (first < zero) & (last > zero);
  const unsigned some = bits(may) & lanes;
  if (some == 0) return;
  Lanes start = my0 / sy;
  larger(start, zero);
  smaller(start, one);
  minima(valley, may, some, ball.reach2, start, at, out.inside);
}

inline unsigned rises(const LaneValley& g) noexcept {
  const Lanes zero{};
  const Valley f{zero + g.b, zero + g.c, zero + g.d, zero + g.ex, zero + g.ey, zero + g.w0, g.sx, g.sy};
  unsigned below = 0;
  unsigned over = 0;
  for (int k = 0; k <= kTwistPieces; k += kWidth) {
    Lanes v, slope, u, height, bend;
    load(v, kPieceEnds.data() + k);
    slopeAt(f, v, slope, u, height, bend);
    below |= bits(slope < zero) << k;
    over |= bits(slope > zero) << k;
  }
  return below & over >> 1 & ((1u << kTwistPieces) - 1u);
}

inline void steepSlopes(const LaneValley& g, const double* v, double* slope, double* bend) noexcept {
  for (int at = 0; at < kSphereContactLanes; at += kWidth) {
    Lanes where;
    load(where, v + at);
    const Lanes p = g.b + g.d * where;
    const Lanes w = g.w0 + g.c * where;
    const Lanes uu = g.sx * g.sx + p * p;
    const Lanes u = (g.sx * g.ex - w * p) / uu;
    const Lanes height = g.sx * (g.sx * w + g.ex * p) / uu;
    const Lanes q = g.c + g.d * u;
    const Lanes uv = p * q + height * g.d;
    store(bend + at, g.sy * g.sy + q * q - uv * uv / uu);
    store(slope + at, g.sy * (g.sy * where - g.ey) + height * q);
  }
}

inline void insides(const LaneCandidates& some, int from, double sx, double sy, const LaneProbe& ball,
                    LaneFinds& out) noexcept {
  out.inside.found = out.twisted = 0;
  for (int at = 0; at < kSphereContactLanes && from + at < some.insides; at += kWidth) {
    const int left = some.insides - from - at;
    const unsigned lanes = left >= kWidth ? kAllLanes : (1u << left) - 1u;
    Facet f;
    Lanes x0, y0;
    load(f.z00, some.z00.data() + from + at);
    load(f.b, some.b.data() + from + at);
    load(f.c, some.c.data() + from + at);
    load(f.d, some.d.data() + from + at);
    load(f.low, some.low.data() + from + at);
    load(f.high, some.high.data() + from + at);
    load(x0, some.x0.data() + from + at);
    load(y0, some.y0.data() + from + at);
    lookInside(sx, sy, ball, f, ball.x - x0, ball.y - y0, lanes, at, out);
  }
}
