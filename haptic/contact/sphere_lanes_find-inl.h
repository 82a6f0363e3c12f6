// The samples around cells, and the contacts of samples, edges and insides for one centre.

// The samples of the cells of one register: their own four, the two beyond to the right and the two above.
struct Around {
  Lanes z00, z10, z20, z01, z11, z21, z02, z12;
  Lanes mx0, mx1, my0, my1;  // the ball's centre from the samples' columns and rows
};

inline void gather(const LaneWindow& w, const LaneProbe& ball, const LaneCell* cells, int count,
                   Around& a) noexcept {
  alignas(Lanes) double column[kWidth], row[kWidth];
  const double* at[kWidth];
  for (int k = 0; k < kWidth; ++k) {
    const LaneCell cell = cells[k < count ? k : 0];
    at[k] = w.z + cell.j * w.columns + cell.i;
    column[k] = w.column + cell.i;
    row[k] = w.row + cell.j;
  }
  across(at, a.z00, a.z10, a.z20);
  for (const double*& z : at) z += w.columns;
  across(at, a.z01, a.z11, a.z21);
  for (const double*& z : at) z += w.columns;
  across(at, a.z02, a.z12);
  Lanes columns, rows;
  load(columns, column);
  load(rows, row);
  a.mx0 = ball.x - columns * w.sx;
  a.mx1 = ball.x - (columns + 1.0) * w.sx;
  a.my0 = ball.y - rows * w.sy;
  a.my1 = ball.y - (rows + 1.0) * w.sy;
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
