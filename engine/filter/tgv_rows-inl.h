// The kernels of tgv_rows.cpp, with bare pointers so that the compiler knows that no two rows overlap; see
// kernel.h.

void duals(int n, float step, const float* __restrict u, const float* __restrict u_next,
           const float* __restrict x, const float* __restrict x_next, const float* __restrict y,
           const float* __restrict y_next, const float* __restrict wp, const float* __restrict wq,
           const float* __restrict wv, float* __restrict p, float* __restrict q, float* __restrict xx,
           float* __restrict yy, float* __restrict xy) noexcept {
  for (int c = 0; c < n; ++c) {
    const float most_p = wp[c], most_q = wq[c];
    float a = p[c] + step * ((u[c + 1] - u[c]) - x[c]);
    float b = q[c] + step * ((u_next[c] - u[c]) - y[c]);
    a = a > most_p ? most_p : a;
    p[c] = a < -most_p ? -most_p : a;
    b = b > most_q ? most_q : b;
    q[c] = b < -most_q ? -most_q : b;
    // A slope has no difference to where no sample is.
    const float right = most_p > 0.0F ? step : 0.0F;
    const float up = most_q > 0.0F ? step : 0.0F;
    const float s = xx[c] + right * (x[c + 1] - x[c]);
    const float t = yy[c] + up * (y_next[c] - y[c]);
    const float d = xy[c] + 0.5F * (right * (y[c + 1] - y[c]) + up * (x_next[c] - x[c]));
    const float most = wv[c];
    const float bound = most * most;
    const float square = (s * s + t * t) + 2.0F * (d * d);
    const float shorter = most / std::sqrt(square > bound ? square : bound);
    xx[c] = s * shorter;
    yy[c] = t * shorter;
    xy[c] = d * shorter;
  }
}

void surface(int n, float step, const float* __restrict f, const float* __restrict p,
             const float* __restrict q, const float* __restrict q_before, const float* __restrict xx,
             const float* __restrict yy, const float* __restrict yy_before, const float* __restrict xy,
             const float* __restrict xy_before, float* __restrict u, float* __restrict u2,
             float* __restrict x, float* __restrict y, float* __restrict x2, float* __restrict y2) noexcept {
  const float to_height = step / (1.0F + step);
  for (int c = 0; c < n; ++c) {
    const float was_u = u[c];
    const float moved = was_u + step * ((p[c] - p[c - 1]) + (q[c] - q_before[c]));
    const float nearer = moved + to_height * (f[c] - moved);
    const float is_u = nearer == nearer ? nearer : moved;
    u[c] = is_u;
    u2[c] = 2.0F * is_u - was_u;
    const float was_x = x[c], was_y = y[c];
    const float is_x = was_x + step * (p[c] + ((xx[c] - xx[c - 1]) + (xy[c] - xy_before[c])));
    const float is_y = was_y + step * (q[c] + ((xy[c] - xy[c - 1]) + (yy[c] - yy_before[c])));
    x[c] = is_x;
    y[c] = is_y;
    x2[c] = 2.0F * is_x - was_x;
    y2[c] = 2.0F * is_y - was_y;
  }
}

void lower(int n, const Weights& most, const float* __restrict u, const float* __restrict u_next,
           const float* __restrict x, const float* __restrict x_next, const float* __restrict y,
           const float* __restrict y_next, float* __restrict wp, float* __restrict wq,
           float* __restrict wv) noexcept {
  const float jump = most.jump * most.half_jump, crease = most.crease * most.half_crease;
  for (int c = 0; c < n; ++c) {
    const float right = wp[c] > 0.0F ? 1.0F : 0.0F;
    const float up = wq[c] > 0.0F ? 1.0F : 0.0F;
    const float a = std::fabs((u[c + 1] - u[c]) - x[c]);
    const float b = std::fabs((u_next[c] - u[c]) - y[c]);
    const float s = right * (x[c + 1] - x[c]);
    const float t = up * (y_next[c] - y[c]);
    const float d = 0.5F * (right * (y[c + 1] - y[c]) + up * (x_next[c] - x[c]));
    const float bend = std::sqrt((s * s + t * t) + 2.0F * (d * d));
    wp[c] = wp[c] > kCut ? jump / (a + most.half_jump) : wp[c];
    wq[c] = wq[c] > kCut ? jump / (b + most.half_jump) : wq[c];
    wv[c] = crease / (bend + most.half_crease);
  }
}

// Adds what one row of a window has, at the height y over its centre.
void addRow(int n, int radius, double y, const float* row, const float* centre, double* __restrict sum,
            double* __restrict squares, double* __restrict along, double* __restrict across) noexcept {
  for (int dx = -radius; dx <= radius; ++dx) {
    const double x = dx;
    for (int c = 0; c < n; ++c) {
      const double h = static_cast<double>(row[c + dx]) - static_cast<double>(centre[c]);
      sum[c] += h;
      squares[c] += h * h;
      along[c] += x * h;
      across[c] += y * h;
    }
  }
}
