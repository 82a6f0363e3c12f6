// The kernels of sphere_contact_lanes.cpp; see kernel.h.
//
// Every expression is that of sphere_window.cpp, in the same order: results are bit-identical.

// One register, whatever its width: GCC 12 compiles comparisons of wider vectors lane by lane.
inline constexpr int kWidth = FETTLE_LEVEL == 0 ? 2 : 4;
inline constexpr unsigned kAllLanes = (1u << kWidth) - 1u;
using Lanes = double __attribute__((vector_size(kWidth * sizeof(double))));
using LaneMask = long long __attribute__((vector_size(kWidth * sizeof(long long))));

// By reference throughout: no ABI defines how a vector wider than the processor's is passed by value.
inline void load(Lanes& to, const double* from) noexcept {
  std::memcpy(&to, from, sizeof to);
}

inline void store(double* to, const Lanes& from) noexcept {
  std::memcpy(to, &from, sizeof from);
}

// 0, 1, 2 ...
inline void numbered(Lanes& to) noexcept {
  constexpr double kNumbers[kSphereContactLanes] = {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0};
  load(to, kNumbers);
}

inline unsigned bits(const LaneMask& mask) noexcept {
#if FETTLE_LEVEL > 0
  __m256d m;
  std::memcpy(&m, &mask, sizeof m);
  return static_cast<unsigned>(_mm256_movemask_pd(m));
#elif defined(__SSE2__)
  __m128d m;
  std::memcpy(&m, &mask, sizeof m);
  return static_cast<unsigned>(_mm_movemask_pd(m));
#else
  unsigned out = 0;
  for (int k = 0; k < kWidth; ++k) out |= mask[k] != 0 ? 1u << k : 0u;
  return out;
#endif
}

inline void larger(Lanes& a, const Lanes& b) noexcept {
  a = a > b ? a : b;
}
inline void smaller(Lanes& a, const Lanes& b) noexcept {
  a = a < b ? a : b;
}
inline void absolute(Lanes& a) noexcept {
  larger(a, -a);
}

inline void squareRoot(Lanes& a) noexcept {
#if FETTLE_LEVEL > 0
  __m256d m;
  std::memcpy(&m, &a, sizeof m);
  m = _mm256_sqrt_pd(m);
  std::memcpy(&a, &m, sizeof m);
#else
  for (int k = 0; k < kWidth; ++k) a[k] = std::sqrt(a[k]);
#endif
}

// Cells from `at` on, those of `lanes`.
inline void keep(LaneContacts& out, int at, unsigned lanes, const LaneMask& found, const Lanes& mx,
                 const Lanes& my, const Lanes& mz, const Lanes& d2) noexcept {
  const unsigned those = bits(found) & lanes;
  if (those == 0) return;
  out.found |= those << at;
  store(out.mx.data() + at, mx);
  store(out.my.data() + at, my);
  store(out.mz.data() + at, mz);
  store(out.d2.data() + at, d2);
}

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
      Lanes top, nx, ny, nz, offset, margin;
      load(top, bounds.top.data() + k);
      load(nx, bounds.nx.data() + k);
      load(ny, bounds.ny.data() + k);
      load(nz, bounds.nz.data() + k);
      load(offset, bounds.offset.data() + k);
      load(margin, bounds.margin.data() + k);
      Lanes gap = ball.z - top;
      larger(gap, zero);
      Lanes over = nx * from_x + ny * from_y + (nz * ball.z + offset);
      absolute(over);
      const unsigned lanes = i1 - i >= kWidth ? kAllLanes : (1u << (i1 - i + 1)) - 1u;
      for (unsigned those = bits((gap * gap + dx2[c] < left) & (over - margin < reach)) & lanes; those != 0;
           those &= those - 1)
        out[n++] = {static_cast<std::int16_t>(i + __builtin_ctz(those)), static_cast<std::int16_t>(j)};
    }
  }
  return n;
}

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

// The samples of the cells of one register: their own four, the two beyond to the right and the two above.
struct Around {
  Lanes z00, z10, z20, z01, z11, z21, z02, z12;
  Lanes mx0, mx1, my0, my1;  // the ball's centre from the samples' columns and rows
};

inline void gather(const LaneWindow& w, const LaneProbe& ball, const LaneCell* cells, int count,
                   Around& a) noexcept {
  struct Corners {
    alignas(Lanes) double z00[kWidth], z10[kWidth], z20[kWidth];
    alignas(Lanes) double z01[kWidth], z11[kWidth], z21[kWidth];
    alignas(Lanes) double z02[kWidth], z12[kWidth];
    alignas(Lanes) double column[kWidth], row[kWidth];
  } in;
  for (int k = 0; k < kWidth; ++k) {
    const LaneCell cell = cells[k < count ? k : 0];
    const double* z = w.z + cell.j * w.columns + cell.i;
    const double* z1 = z + w.columns;
    const double* z2 = z1 + w.columns;
    in.z00[k] = z[0];
    in.z10[k] = z[1];
    in.z20[k] = z[2];
    in.z01[k] = z1[0];
    in.z11[k] = z1[1];
    in.z21[k] = z1[2];
    in.z02[k] = z2[0];
    in.z12[k] = z2[1];
    in.column[k] = w.column + cell.i;
    in.row[k] = w.row + cell.j;
  }
  Lanes column, row;
  load(a.z00, in.z00);
  load(a.z10, in.z10);
  load(a.z20, in.z20);
  load(a.z01, in.z01);
  load(a.z11, in.z11);
  load(a.z21, in.z21);
  load(a.z02, in.z02);
  load(a.z12, in.z12);
  load(column, in.column);
  load(row, in.row);
  a.mx0 = ball.x - column * w.sx;
  a.mx1 = ball.x - (column + 1.0) * w.sx;
  a.my0 = ball.y - row * w.sy;
  a.my1 = ball.y - (row + 1.0) * w.sy;
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

// The cells of one register; results go to `at` and following.
inline void lookAt(const LaneWindow& w, const LaneProbe& ball, const LaneCell* cells, int count, int at,
                   LaneFinds& out) noexcept {
  Around a;
  gather(w, ball, cells, count, a);
  const Lanes z00 = a.z00, z10 = a.z10, z20 = a.z20, z01 = a.z01, z11 = a.z11, z21 = a.z21, z02 = a.z02,
              z12 = a.z12, mx0 = a.mx0, mx1 = a.mx1, my0 = a.my0, my1 = a.my1;
  const unsigned lanes = (1u << count) - 1u;
  const Lanes zero{};

  {  // the sample at the upper right corner
    const Lanes mz = ball.z - z11;
    const Lanes d2 = mx1 * mx1 + my1 * my1 + mz * mz;
    const Lanes along_x = mx1 * w.sx;
    const Lanes along_y = my1 * w.sy;
    const LaneMask found = (d2 < ball.reach2) & (mz >= zero) & (mz * (z01 - z11) <= along_x + ball.seam_x) &
                           (mz * (z21 - z11) <= ball.seam_x - along_x) &
                           (mz * (z10 - z11) <= along_y + ball.seam_y) &
                           (mz * (z12 - z11) <= ball.seam_y - along_y);
    keep(out.sample, at, lanes, found, mx1, my1, mz, d2);
  }
  {  // the edge along x above
    const Lanes qz = ball.z - z01;
    const Lanes ez = z11 - z01;
    const Lanes ahead = mx0 * w.sx + qz * ez;
    const Lanes length2 = w.sx * w.sx + ez * ez;
    const Lanes t = ahead / length2;
    const Lanes mx = mx0 - t * w.sx;
    const Lanes mz = qz - t * ez;
    const Lanes d2 = mx * mx + my1 * my1 + mz * mz;
    const Lanes here = z01 + t * ez;
    const LaneMask found = (ahead > zero) & (ahead < length2) & (d2 < ball.reach2) & (mz >= zero) &
                           (mz * (z00 + t * (z10 - z00) - here) <= my1 * w.sy + ball.seam_y) &
                           (mz * (z02 + t * (z12 - z02) - here) <= ball.seam_y - my1 * w.sy);
    keep(out.edge_x, at, lanes, found, mx, my1, mz, d2);
    store(out.edge_x.u.data() + at, t);
  }
  {  // the edge along y to the right
    const Lanes qz = ball.z - z10;
    const Lanes ez = z11 - z10;
    const Lanes ahead = my0 * w.sy + qz * ez;
    const Lanes length2 = w.sy * w.sy + ez * ez;
    const Lanes t = ahead / length2;
    const Lanes my = my0 - t * w.sy;
    const Lanes mz = qz - t * ez;
    const Lanes d2 = mx1 * mx1 + my * my + mz * mz;
    const Lanes here = z10 + t * ez;
    const LaneMask found = (ahead > zero) & (ahead < length2) & (d2 < ball.reach2) & (mz >= zero) &
                           (mz * (z00 + t * (z01 - z00) - here) <= mx1 * w.sx + ball.seam_x) &
                           (mz * (z20 + t * (z21 - z20) - here) <= ball.seam_x - mx1 * w.sx);
    keep(out.edge_y, at, lanes, found, mx1, my, mz, d2);
    store(out.edge_y.v.data() + at, t);
  }

  Lanes low = z00;
  Lanes high = z00;
  larger(high, z10);
  larger(high, z01);
  larger(high, z11);
  smaller(low, z10);
  smaller(low, z01);
  smaller(low, z11);
  const Lanes b = z10 - z00;
  const Lanes c = z01 - z00;
  lookInside(w.sx, w.sy, ball, {z00, b, c, (z11 - z01) - b, low, high}, mx0, my0, lanes, at, out);
}

inline void find(const LaneWindow& w, const LaneProbe& ball, const LaneCell* cells, int count,
                 LaneFinds& out) noexcept {
  out.sample.found = out.edge_x.found = out.edge_y.found = out.inside.found = out.twisted = 0;
  for (int at = 0; at < count; at += kWidth)
    lookAt(w, ball, cells + at, count - at < kWidth ? count - at : kWidth, at, out);
}

inline unsigned rises(const LaneWindow& w, const LaneProbe& ball, LaneCell cell) noexcept {
  const double* z = w.z + cell.j * w.columns + cell.i;
  const Lanes zero{};
  const double b = z[1] - z[0];
  const double c = z[w.columns] - z[0];
  const double d = (z[w.columns + 1] - z[w.columns]) - b;
  const Valley f{zero + b,
                 zero + c,
                 zero + d,
                 zero + (ball.x - (w.column + cell.i) * w.sx),
                 zero + (ball.y - (w.row + cell.j) * w.sy),
                 zero + (z[0] - ball.z),
                 w.sx,
                 w.sy};
  Lanes count;
  numbered(count);
  unsigned below = 0;
  unsigned over = 0;
  for (int k = 0; k <= kTwistPieces; k += kWidth) {
    Lanes slope, u, height, bend;
    slopeAt(f, (count + static_cast<double>(k)) / static_cast<double>(kTwistPieces), slope, u, height, bend);
    below |= bits(slope < zero) << k;
    over |= bits(slope > zero) << k;
  }
  return below & over >> 1 & ((1u << kTwistPieces) - 1u);
}

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

inline SphereContactKernels kernels() noexcept {
  return {reached, prepare, find, rises, candidates, insides};
}
