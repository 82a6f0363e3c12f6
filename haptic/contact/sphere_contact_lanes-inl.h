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

inline int reached(const LaneWindow& w, const LaneProbe& ball, std::int32_t i0, std::int32_t i1,
                   std::int32_t j0, std::int32_t j1, LaneCell* out) noexcept {
  const Lanes zero{};
  Lanes count;
  numbered(count);
  // Values of the columns that all rows share.
  struct Columns {
    Lanes dx2;  // squared distance along x
    Lanes away;
    unsigned lanes;
  };
  constexpr int kMostChunks = 48 / kWidth;
  std::array<Columns, kMostChunks> all;
  int chunks = 0;
  for (std::int32_t i = i0; i <= i1 && chunks < kMostChunks; i += kWidth) {
    const Lanes column = count + static_cast<double>(w.column + i);
    Lanes dx = column * w.sx - ball.x;
    larger(dx, ball.x - (column + 1.0) * w.sx);
    larger(dx, zero);
    Columns& chunk = all[static_cast<std::size_t>(chunks++)];
    chunk.dx2 = dx * dx;
    chunk.away = ball.x - (column + 0.5) * w.sx;
    chunk.lanes = i1 - i >= kWidth ? kAllLanes : (1u << (i1 - i + 1)) - 1u;
  }
  int n = 0;
  for (std::int32_t j = j0; j <= j1; ++j) {
    const double y0 = (w.row + j) * w.sy;
    const double y1 = (w.row + j + 1) * w.sy;
    const double dy = y0 - ball.y > 0.0 ? y0 - ball.y : (ball.y - y1 > 0.0 ? ball.y - y1 : 0.0);
    const double left = ball.reach2 - dy * dy;
    if (!(left > 0.0)) continue;
    for (int k = 0; k < chunks; ++k) {
      const Columns& chunk = all[static_cast<std::size_t>(k)];
      const std::int32_t i = i0 + k * kWidth;
      Lanes z00, z10, z01, z11;
      const double* z = w.z + j * w.columns + i;
      load(z00, z);
      load(z10, z + 1);
      load(z01, z + w.columns);
      load(z11, z + w.columns + 1);
      Lanes highest = z00;
      larger(highest, z10);
      larger(highest, z01);
      larger(highest, z11);
      Lanes gap = ball.z - highest;
      larger(gap, zero);
      // The patch differs from its middle plane by at most a quarter of its twist.
      const Lanes p = 0.5 * (z10 - z00 + z11 - z01) / w.sx;
      const Lanes q = 0.5 * (z01 - z00 + z11 - z10) / w.sy;
      Lanes d = z11 - z10 - z01 + z00;
      absolute(d);
      const Lanes middle = 0.25 * (z00 + z10 + z01 + z11);
      Lanes over = ball.z - middle - p * chunk.away - q * (ball.y - (w.row + j + 0.5) * w.sy);
      absolute(over);
      over -= 0.25 * d;
      const LaneMask near = gap * gap + chunk.dx2 < left;
      const LaneMask far = (over > zero) & (over * over > ball.reach2 * (1.0 + p * p + q * q) * (1.0 + 1e-9));
      for (unsigned left_over = bits(near & ~far) & chunk.lanes; left_over != 0; left_over &= left_over - 1)
        out[n++] = {static_cast<std::int16_t>(i + __builtin_ctz(left_over)), static_cast<std::int16_t>(j)};
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

// The cells of one register; results go to `at` and following.
inline void lookAt(const LaneWindow& w, const LaneProbe& ball, const LaneCell* cells, int count, int at,
                   LaneFinds& out) noexcept {
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
  Lanes z00, z10, z20, z01, z11, z21, z02, z12, column, row;
  load(z00, in.z00);
  load(z10, in.z10);
  load(z20, in.z20);
  load(z01, in.z01);
  load(z11, in.z11);
  load(z21, in.z21);
  load(z02, in.z02);
  load(z12, in.z12);
  load(column, in.column);
  load(row, in.row);
  const unsigned lanes = (1u << count) - 1u;
  const Lanes zero{};
  const Lanes one = zero + 1.0;
  const Lanes mx0 = ball.x - column * w.sx;
  const Lanes mx1 = ball.x - (column + 1.0) * w.sx;
  const Lanes my0 = ball.y - row * w.sy;
  const Lanes my1 = ball.y - (row + 1.0) * w.sy;

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

  // The inside.
  const Lanes b = z10 - z00;
  const Lanes c = z01 - z00;
  const Lanes d = (z11 - z01) - b;
  Lanes low = z00;
  Lanes high = z00;
  larger(high, z10);
  larger(high, z01);
  larger(high, z11);
  smaller(low, z10);
  smaller(low, z01);
  smaller(low, z11);
  const Valley valley{b, c, d, mx0, my0, z00 - ball.z, w.sx, w.sy};
  // Where the surface's normal goes through the centre, sx (sx u - ex) = -height p and likewise along v; no
  // such point when the two sides have no value in common over the whole cell.
  Lanes above = ball.z - high;  // -height, at least and at most
  larger(above, zero);
  const Lanes above_most = ball.z - low;
  LaneMask may = above_most > zero;
  const auto crosses = [&](const Lanes& slope0, const Lanes& e, double s) {
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
    const double margin = 1e-6 * s * s;  // far above rounding
    may &= (most > -at0 - margin) & (least < s * s - at0 + margin);
  };
  crosses(b, mx0, w.sx);
  crosses(c, my0, w.sy);
  if ((bits(may) & lanes) == 0) return;

  // Second derivatives of the distance, halved: sx^2 + p^2, sy^2 + q^2, p q + z d.
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
  Lanes zd = ball.z - high;
  const Lanes bridge = twist * above - p * q;
  absolute(zd);
  Lanes below = ball.z - low;
  absolute(below);
  larger(zd, below);
  zd = twist * zd;
  const LaneMask convex = zd * (2.0 * p * q + zd) < w.sx * w.sx * w.sy * w.sy;
  // Twisted so much that the ball bridges it: no minimum inside, only saddles.
  const LaneMask bridged =
      (bridge > zero) & (bridge * bridge > (w.sx * w.sx + p * p) * (w.sy * w.sy + q * q));
  out.twisted |= (bits(may & ~convex & ~bridged) & lanes) << at;
  may &= convex;
  if ((bits(may) & lanes) == 0) return;
  Lanes u, height, bend, first, last;
  slopeAt(valley, zero, first, u, height, bend);
  slopeAt(valley, one, last, u, height, bend);
  may &= (first < zero) & (last > zero);
  const unsigned some = bits(may) & lanes;
  if (some == 0) return;
  Lanes start = my0 / w.sy;
  larger(start, zero);
  smaller(start, one);
  minima(valley, may, some, ball.reach2, start, at, out.inside);
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

inline SphereContactKernels kernels() noexcept {
  return {reached, find, rises};
}
