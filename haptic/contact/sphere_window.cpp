#include "haptic/contact/sphere_window.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <glm/geometric.hpp>

#include "haptic/contact/normal.h"

namespace fettle::haptic {

namespace {

// Of two cells at least one must report a contact on their common side: the relative rounding allowed in that
// comparison. A contact reported twice does no harm, both are the same.
constexpr double kSeam = 1e-10;

double beyond(double x, double low, double high) noexcept {
  return std::max({low - x, x - high, 0.0});
}

// Index of a coordinate, within [low, high] whatever the coordinate is.
std::int32_t indexWithin(double x, std::int32_t low, std::int32_t high) noexcept {
  return static_cast<std::int32_t>(
      std::clamp(std::floor(x), static_cast<double>(low), static_cast<double>(high)));
}

LaneProbe laneProbe(const glm::dvec3& centre, double reach, double sx, double sy) noexcept {
  return {centre.x, centre.y, centre.z, reach, reach * reach, kSeam * reach * sx, kSeam * reach * sy};
}

}  // namespace

void SphereWindow::load(const Surface& surface, const glm::dvec3& centre, double reach_mm,
                        double room_mm) noexcept {
  const engine::FieldReader& reader = surface.reader();
  sx_ = surface.spacingX();
  sy_ = surface.spacingY();
  const double around = reach_mm + room_mm;
  // One cell more than the ball reaches: its neighbour decides whether a side of a cell is a rim.
  const auto first = [&](double x, double s, std::int32_t samples) {
    return indexWithin((x - around) / s, -1, samples + 1) - 1;
  };
  const auto last = [&](double x, double s, std::int32_t samples) {
    return indexWithin((x + around) / s, -1, samples + 1) + 2;
  };
  column_ = first(centre.x, sx_, reader.width());
  row_ = first(centre.y, sy_, reader.height());
  columns_ = std::min(last(centre.x, sx_, reader.width()) - column_ + 1, kMostSide);
  rows_ = std::min(last(centre.y, sy_, reader.height()) - row_ + 1, kMostSide);
  low_x_ = centre.x - room_mm;
  high_x_ = centre.x + room_mm;
  low_y_ = centre.y - room_mm;
  high_y_ = centre.y + room_mm;

  reader.readHeights(column_, row_, columns_, rows_, raw_.data(), columns_);
  const double unit = surface.heightUnit();
  const std::int32_t samples = columns_ * rows_;
  double highest = -HUGE_VAL;
  double lowest = HUGE_VAL;
  double sum = 0.0;  // NaN when there is one; separate from the maximum, which ignores NaN
  for (std::int32_t k = 0; k < samples; ++k) {
    const double z = unit * static_cast<double>(raw_[static_cast<std::size_t>(k)]);
    z_[static_cast<std::size_t>(k)] = z;
    highest = z > highest ? z : highest;
    lowest = z < lowest ? z : lowest;
    sum += z * 0.0;
  }
  highest_ = highest;
  whole_ = sum == 0.0;
  gathered_ = false;
  // Farther from 0 than that, roundings of a height are not small beside the bounds' room for them.
  boundable_ = std::max(highest, -lowest) <= 1e8 * std::min(sx_, sy_);
  sphereContactKernels().prepare(laneWindow(), rows_, boundable_ ? 0.0 : HUGE_VAL, bounds_);
  markRims();
}

// Cells that the lanes cannot look at.
void SphereWindow::markRims() noexcept {
  const auto rim = [&](std::int32_t i, std::int32_t j) -> std::uint8_t& {
    return bounds_.rim[static_cast<std::size_t>(j * columns_ + i)];
  };
  if (whole_) {
    // Its border, which a ball that it holds does not reach: neighbours are missing there.
    std::fill_n(bounds_.rim.begin(), columns_ * rows_, std::uint8_t{0});
    for (std::int32_t i = 0; i + 1 < columns_; ++i) rim(i, 0) = rim(i, rows_ - 2) = 1;
    for (std::int32_t j = 0; j + 1 < rows_; ++j) rim(0, j) = rim(columns_ - 2, j) = 1;
    return;
  }
  for (std::int32_t j = 0; j + 1 < rows_; ++j)
    for (std::int32_t i = 0; i + 1 < columns_; ++i) {
      bool inner = true;
      for (std::int32_t k = 0; k < 9 && inner; ++k) inner = valid(i + k % 3 - 1, j + k / 3 - 1);
      rim(i, j) = inner ? 0 : 1;
      // It has walls below its plane; only its highest sample bounds them.
      if (!inner && valid(i, j)) bounds_.margin[static_cast<std::size_t>(j * columns_ + i)] = HUGE_VAL;
    }
}

bool SphereWindow::holds(const glm::dvec3& centre) const noexcept {
  return centre.x >= low_x_ && centre.x <= high_x_ && centre.y >= low_y_ && centre.y <= high_y_;
}

bool SphereWindow::valid(std::int32_t i, std::int32_t j) const noexcept {
  if (i < 0 || j < 0 || i + 1 >= columns_ || j + 1 >= rows_) return false;
  if (whole_) return true;
  const Corners z = corners(i, j);
  return !std::isnan(z.z00 + z.z10 + z.z01 + z.z11);
}

bool SphereWindow::under(const glm::dvec3& at, SphereContact& out) const noexcept {
  const double x = at.x / sx_ - column_;
  const double y = at.y / sy_ - row_;
  if (!(x >= 0.0 && y >= 0.0 && x < columns_ - 1 && y < rows_ - 1)) return false;
  const auto i = static_cast<std::int32_t>(x);
  const auto j = static_cast<std::int32_t>(y);
  // On a line between cells the one without a hole counts.
  for (const std::int32_t jj : {j, y == j ? j - 1 : j})
    for (const std::int32_t ii : {i, x == i ? i - 1 : i}) {
      if (!valid(ii, jj)) continue;
      const Corners z = corners(ii, jj);
      const double b = z.z10 - z.z00;
      const double c = z.z01 - z.z00;
      const double d = (z.z11 - z.z01) - b;
      out.u = x - ii;
      out.v = y - jj;
      out.cell = {column_ + ii, row_ + jj};
      const Patch patch{(column_ + ii) * sx_, (row_ + jj) * sy_, sx_, sy_, z.z00, b, c, d};
      out.point_mm = patch.at(out.u, out.v);
      out.normal = patchNormal(patch, out.u, out.v);
      out.distance_mm = std::abs(at.z - out.point_mm.z);
      return true;
    }
  return false;
}

double SphereWindow::heightUnder(const glm::dvec3& at) const noexcept {
  const double x = at.x / sx_ - column_;
  const double y = at.y / sy_ - row_;
  if (whole_ && x >= 0.0 && y >= 0.0 && x < columns_ - 1 && y < rows_ - 1) [[likely]] {
    const auto i = static_cast<std::int32_t>(x);
    const auto j = static_cast<std::int32_t>(y);
    const Corners z = corners(i, j);
    const double u = x - i;
    const double v = y - j;
    return z.z00 + (z.z10 - z.z00) * u + ((z.z01 - z.z00) + (z.z11 - z.z10 - z.z01 + z.z00) * u) * v;
  }
  SphereContact point;
  return under(at, point) ? point.point_mm.z : -HUGE_VAL;
}

// The squared distance to the nearest of S(u, v), halved, has the second derivative I - J H^-1 J^T (the foot
// moves with the centre): J the surface's derivatives that are free at the touch, H its own second
// derivatives in them. The distance is the root of twice that.
double SphereWindow::bend(const glm::dvec3& centre, const SphereContact& touch, const glm::dvec3& a,
                          const glm::dvec3& b) const noexcept {
  const glm::dvec3 m = centre - touch.point_mm;
  const double distance = glm::length(m);
  if (!(distance > 0.0)) return 0.0;
  const auto i = static_cast<std::int32_t>(touch.cell.column - column_);
  const auto j = static_cast<std::int32_t>(touch.cell.row - row_);
  double foot = 0.0;
  if (valid(i, j)) {
    const Corners z = corners(i, j);
    const double d = z.z11 - z.z10 - z.z01 + z.z00;
    const glm::dvec3 su{sx_, 0.0, z.z10 - z.z00 + d * touch.v};
    const glm::dvec3 sv{0.0, sy_, z.z01 - z.z00 + d * touch.u};
    const bool along_u = touch.u > 0.0 && touch.u < 1.0;
    const bool along_v = touch.v > 0.0 && touch.v < 1.0;
    const double uu = glm::dot(su, su);
    const double vv = glm::dot(sv, sv);
    const double au = glm::dot(a, su);
    const double av = glm::dot(a, sv);
    const double bu = glm::dot(b, su);
    const double bv = glm::dot(b, sv);
    if (along_u && along_v) {
      const double uv = glm::dot(su, sv) - m.z * d;
      const double det = uu * vv - uv * uv;
      if (!(det > 1e-6 * uu * vv)) return 0.0;
      foot = (au * bu * vv + av * bv * uu - (au * bv + av * bu) * uv) / det;
    } else if (along_u) {
      foot = au * bu / uu;
    } else if (along_v) {
      foot = av * bv / vv;
    }
  }
  return (glm::dot(a, b) - foot) / distance;
}

// One search for contacts: everything relative to the centre.
class SphereWindow::Collector {
 public:
  Collector(const SphereWindow& window, const glm::dvec3& centre, double reach,
            SphereContactList& out) noexcept
      : w_(window),
        c_(centre),
        reach_(reach),
        reach2_(reach * reach),
        seam_x_(kSeam * reach * window.sx_),
        seam_y_(kSeam * reach * window.sy_),
        out_(out) {
    out.count = 0;
    out.nearest_mm = HUGE_VAL;
  }

  void cell(std::int32_t i, std::int32_t j) noexcept;
  void vectorised(std::int32_t i0, std::int32_t i1, std::int32_t j0, std::int32_t j1) noexcept;
  void candidates(const LaneCandidates& some) noexcept;

 private:
  // Contacts are kept with squared distance first; the root is taken of those that remain.
  void add(std::int32_t i, std::int32_t j, double u, double v, const glm::dvec3& m, double d2) noexcept {
    const double distance = std::sqrt(d2);
    out_.nearest_mm = std::min(out_.nearest_mm, distance);
    int at = out_.count;
    if (at == SphereContactList::kMost) {
      at = 0;
      for (int k = 1; k < SphereContactList::kMost; ++k)
        if (out_.contacts[static_cast<std::size_t>(k)].distance_mm >
            out_.contacts[static_cast<std::size_t>(at)].distance_mm)
          at = k;
      if (out_.contacts[static_cast<std::size_t>(at)].distance_mm <= distance) return;
    } else {
      ++out_.count;
    }
    SphereContact& t = out_.contacts[static_cast<std::size_t>(at)];
    t.point_mm = c_ - m;
    // A centre on the surface itself has no direction; up is always valid.
    t.normal = distance > 0.0 ? m * (1.0 / distance) : glm::dvec3(0.0, 0.0, 1.0);
    t.distance_mm = distance;
    t.cell = {w_.column_ + i, w_.row_ + j};
    t.u = u;
    t.v = v;
  }

  // Sides of a sample along which there is a surface.
  struct Arms {
    bool left, right, down, up;
  };
  [[nodiscard]] Arms arms(std::int32_t i, std::int32_t j) const noexcept {
    if (w_.whole_) [[likely]]
      return {true, true, true, true};
    const bool ll = w_.valid(i - 1, j - 1);
    const bool lr = w_.valid(i, j - 1);
    const bool ul = w_.valid(i - 1, j);
    const bool ur = w_.valid(i, j);
    return {ll || ul, lr || ur, ll || lr, ul || ur};
  }

  // Sample (i, j), reported as corner (u, v) of cell (ci, cj).
  void sample(std::int32_t i, std::int32_t j, std::int32_t ci, std::int32_t cj, double u, double v) noexcept {
    const double* z = w_.z_.data() + j * w_.columns_ + i;
    const glm::dvec3 m{c_.x - (w_.column_ + i) * w_.sx_, c_.y - (w_.row_ + j) * w_.sy_, c_.z - z[0]};
    const double d2 = m.x * m.x + m.y * m.y + m.z * m.z;
    if (!(d2 < reach2_) || m.z < 0.0) return;
    const Arms a = arms(i, j);
    const double along_x = m.x * w_.sx_;
    const double along_y = m.y * w_.sy_;
    if (a.left && m.z * (z[-1] - z[0]) > along_x + seam_x_) return;
    if (a.right && m.z * (z[1] - z[0]) > seam_x_ - along_x) return;
    if (a.down && m.z * (z[-w_.columns_] - z[0]) > along_y + seam_y_) return;
    if (a.up && m.z * (z[w_.columns_] - z[0]) > seam_y_ - along_y) return;
    add(ci, cj, u, v, m, d2);
  }

  // The edge along x above (i, j)-(i+1, j), reported as side v of cell (ci, cj); cells below and above it.
  void edgeX(std::int32_t i, std::int32_t j, std::int32_t ci, std::int32_t cj, double v, bool below,
             bool above) noexcept {
    const double* z = w_.z_.data() + j * w_.columns_ + i;
    const double qx = c_.x - (w_.column_ + i) * w_.sx_;
    const double my = c_.y - (w_.row_ + j) * w_.sy_;
    const double qz = c_.z - z[0];
    const double ez = z[1] - z[0];
    const double ahead = qx * w_.sx_ + qz * ez;
    const double length2 = w_.sx_ * w_.sx_ + ez * ez;
    if (!(ahead > 0.0 && ahead < length2)) return;
    const double t = ahead / length2;
    const glm::dvec3 m{qx - t * w_.sx_, my, qz - t * ez};
    const double d2 = m.x * m.x + m.y * m.y + m.z * m.z;
    if (!(d2 < reach2_) || m.z < 0.0) return;
    const double here = z[0] + t * ez;
    const std::int32_t s = w_.columns_;
    if (below && m.z * (z[-s] + t * (z[1 - s] - z[-s]) - here) > my * w_.sy_ + seam_y_) return;
    if (above && m.z * (z[s] + t * (z[1 + s] - z[s]) - here) > seam_y_ - my * w_.sy_) return;
    add(ci, cj, t, v, m, d2);
  }

  void edgeY(std::int32_t i, std::int32_t j, std::int32_t ci, std::int32_t cj, double u, bool left,
             bool right) noexcept {
    const std::int32_t s = w_.columns_;
    const double* z = w_.z_.data() + j * s + i;
    const double mx = c_.x - (w_.column_ + i) * w_.sx_;
    const double qy = c_.y - (w_.row_ + j) * w_.sy_;
    const double qz = c_.z - z[0];
    const double ez = z[s] - z[0];
    const double ahead = qy * w_.sy_ + qz * ez;
    const double length2 = w_.sy_ * w_.sy_ + ez * ez;
    if (!(ahead > 0.0 && ahead < length2)) return;
    const double t = ahead / length2;
    const glm::dvec3 m{mx, qy - t * w_.sy_, qz - t * ez};
    const double d2 = m.x * m.x + m.y * m.y + m.z * m.z;
    if (!(d2 < reach2_) || m.z < 0.0) return;
    const double here = z[0] + t * ez;
    if (left && m.z * (z[-1] + t * (z[s - 1] - z[-1]) - here) > mx * w_.sx_ + seam_x_) return;
    if (right && m.z * (z[1] + t * (z[s + 1] - z[1]) - here) > seam_x_ - mx * w_.sx_) return;
    add(ci, cj, u, t, m, d2);
  }

  // The wall below a rim: `out` is how far the centre is out of its side, `along` where along it in [0, 1].
  void wall(std::int32_t ci, std::int32_t cj, std::int32_t i, std::int32_t j, bool along_x, double side,
            double out) noexcept;

  void minimum(std::int32_t i, std::int32_t j, Valley& g, double low, double high, double v) noexcept;
  void minimumOfPiece(std::int32_t i, std::int32_t j, Valley& g, int piece) noexcept;
  void inside(std::int32_t i, std::int32_t j, const Corners& z) noexcept;
  void twisted(std::int32_t i, std::int32_t j) noexcept;
  void rims(std::int32_t i, std::int32_t j) noexcept;

  const SphereWindow& w_;
  glm::dvec3 c_;
  double reach_, reach2_, seam_x_, seam_y_;
  SphereContactList& out_;
};

// Minima inside the cell. The distance is quadratic in u, so that along v there is a function of v alone,
//   g(v) = min over u of f(u, v),   u(v) = (sx ex - w p) / (sx^2 + p^2),   p = b + d v,   w = a - cz + c v,
// (halves throughout), whose minima with 0 < u(v) < 1 are those of the patch (the reduction of
// certified.cpp).
class SphereWindow::Valley {
 public:
  Valley(const SphereWindow& w, const glm::dvec3& centre, std::int32_t i, std::int32_t j,
         const Corners& z) noexcept
      : sx(w.sx_),
        sy(w.sy_),
        b(z.z10 - z.z00),
        c(z.z01 - z.z00),
        d((z.z11 - z.z01) - b),
        ex(centre.x - (w.column_ + i) * sx),
        ey(centre.y - (w.row_ + j) * sy),
        w0(z.z00 - centre.z) {}

  // Slope of g; also stores u, the height and g's second derivative.
  [[nodiscard]] double slopeAt(double v) noexcept {
    const double p = b + d * v;
    const double w = w0 + c * v;
    const double uu = sx * sx + p * p;
    u = (sx * ex - w * p) / uu;
    height = w + p * u;
    const double q = c + d * u;
    const double uv = p * q + height * d;
    bend = sy * sy + q * q - uv * uv / uu;
    return sy * (sy * v - ey) + height * q;
  }

  // Whether a piece may hold a minimum nearer than the reach. u (sx^2 + p^2) = sx ex - w p, where p and w are
  // linear along v: from their ends a range of u, from that a range of heights, all wider than any rounding.
  [[nodiscard]] bool mayHold(int piece, double reach2) const noexcept {
    constexpr double kWider = 1e-9;
    const double v0 = static_cast<double>(piece) / kTwistPieces;
    const double v1 = (piece + 1.0) / kTwistPieces;
    const double p0 = b + d * v0;
    const double p1 = b + d * v1;
    const double h0 = w0 + c * v0;
    const double h1 = w0 + c * v1;
    const auto [least, most] = std::minmax({h0 * p0, h0 * p1, h1 * p0, h1 * p1});
    const auto [flat, steep] = std::minmax({p0 * p0, p1 * p1});
    const double uu_most = sx * sx + steep;
    const double uu_least = sx * sx + (p0 * p1 > 0.0 ? flat : 0.0);
    const double at = sx * ex;
    const double margin = kWider * (uu_most + std::abs(at) + std::max(most, -least));
    const double n_least = at - most - margin;
    const double n_most = at - least + margin;
    if (n_most < 0.0 || n_least > uu_most) return false;
    const double u0 = std::max(n_least / uu_most - kWider, 0.0);
    const double u1 = std::min(n_most / uu_least + kWider, 1.0);
    const auto [lowest, highest] = std::minmax({h0 + p0 * u0, h0 + p0 * u1, h1 + p1 * u0, h1 + p1 * u1});
    const double margin_z = kWider * (std::abs(h0) + std::abs(h1) + std::abs(p0) + std::abs(p1));
    if (lowest > margin_z) return false;
    const double mx = beyond(ex, sx * u0, sx * u1);
    const double my = beyond(ey, sy * v0, sy * v1);
    const double mz = std::max(-highest - margin_z, 0.0);
    return mx * mx + my * my + mz * mz <= reach2 * (1.0 + 1e-6);
  }

  double sx, sy, b, c, d, ex, ey, w0;
  double u = 0.0, height = 0.0, bend = 0.0;
};

// Newton's method, kept within a bracket where g falls at `low` and rises at `high`.
void SphereWindow::Collector::minimum(std::int32_t i, std::int32_t j, Valley& g, double low, double high,
                                      double v) noexcept {
  for (int round = 0; round < 40; ++round) {
    const double slope = g.slopeAt(v);
    (slope < 0.0 ? low : high) = v;
    const double next = g.bend > 0.0 ? v - slope / g.bend : -1.0;
    const double to = next > low && next < high ? next : 0.5 * (low + high);
    const double moved = std::abs(to - v);
    v = to;
    if (moved < 1e-6) break;
  }
  (void)g.slopeAt(v);
  if (!(g.u > 0.0 && g.u < 1.0 && v > 0.0 && v < 1.0 && g.height < 0.0)) return;
  const glm::dvec3 m{g.ex - g.u * g.sx, g.ey - v * g.sy, -g.height};
  const double d2 = m.x * m.x + m.y * m.y + m.z * m.z;
  if (d2 < reach2_) add(i, j, g.u, v, m, d2);
}

void SphereWindow::Collector::minimumOfPiece(std::int32_t i, std::int32_t j, Valley& g, int piece) noexcept {
  minimum(i, j, g, static_cast<double>(piece) / kTwistPieces, (piece + 1.0) / kTwistPieces,
          (piece + 0.5) / kTwistPieces);
}

void SphereWindow::Collector::inside(std::int32_t i, std::int32_t j, const Corners& z) noexcept {
  Valley g(w_, c_, i, j, z);
  const double sx = g.sx;
  const double sy = g.sy;
  // Second derivatives of the distance, halved: sx^2 + p^2, sy^2 + q^2, p q + z d.
  const double p = std::max(std::abs(g.b), std::abs(g.b + g.d));
  const double q = std::max(std::abs(g.c), std::abs(g.c + g.d));
  const double high = std::max({z.z00, z.z10, z.z01, z.z11});
  const double low = std::min({z.z00, z.z10, z.z01, z.z11});
  const double zd = std::abs(g.d) * std::max(std::abs(c_.z - high), std::abs(c_.z - low));
  if (zd * (2.0 * p * q + zd) < sx * sx * sy * sy) {
    // Convex: one minimum at most.
    const double first = g.slopeAt(0.0);
    const double last = g.slopeAt(1.0);
    if (first < 0.0 && last > 0.0) minimum(i, j, g, 0.0, 1.0, std::clamp(g.ey / sy, 0.0, 1.0));
    return;
  }
  // Twisted so much that the ball bridges it: no minimum inside, only saddles.
  const double bridge = std::abs(g.d) * std::max(0.0, c_.z - high) - p * q;
  if (bridge > 0.0 && bridge * bridge > (sx * sx + p * p) * (sy * sy + q * q)) return;
  double before = g.slopeAt(0.0);
  for (int k = 1; k <= kTwistPieces; ++k) {
    const double after = g.slopeAt(static_cast<double>(k) / kTwistPieces);
    if (before < 0.0 && after > 0.0) minimumOfPiece(i, j, g, k - 1);
    before = after;
  }
}

void SphereWindow::Collector::wall(std::int32_t ci, std::int32_t cj, std::int32_t i, std::int32_t j,
                                   bool along_x, double side, double out) noexcept {
  if (out < 0.0 || out >= reach_) return;
  const double* z = w_.z_.data() + j * w_.columns_ + i;
  const double s = along_x ? w_.sx_ : w_.sy_;
  const double q = along_x ? c_.x - (w_.column_ + i) * s : c_.y - (w_.row_ + j) * s;
  const double t = std::clamp(q / s, 0.0, 1.0);
  const double other = along_x ? z[1] : z[w_.columns_];
  if (c_.z >= z[0] + t * (other - z[0])) return;  // above the rim: its edge and its samples handle that
  const bool at_end = q < 0.0 || q > s;
  const std::int32_t vi = i + (along_x && t == 1.0 ? 1 : 0);
  const std::int32_t vj = j + (!along_x && t == 1.0 ? 1 : 0);
  const double mx = along_x && !at_end ? 0.0 : c_.x - (w_.column_ + vi) * w_.sx_;
  const double my = !along_x && !at_end ? 0.0 : c_.y - (w_.row_ + vj) * w_.sy_;
  if (at_end) {
    const Arms a = arms(vi, vj);
    if ((a.left && mx < 0.0) || (a.right && mx > 0.0) || (a.down && my < 0.0) || (a.up && my > 0.0)) return;
  }
  const double d2 = mx * mx + my * my;
  if (!(d2 < reach2_)) return;
  add(ci, cj, along_x ? t : side, along_x ? side : t, {mx, my, 0.0}, d2);
}

// What the cells below and to the left would report, where there are none; and the walls.
void SphereWindow::Collector::rims(std::int32_t i, std::int32_t j) noexcept {
  const bool left = w_.valid(i - 1, j);
  const bool below = w_.valid(i, j - 1);
  const double x0 = (w_.column_ + i) * w_.sx_;
  const double y0 = (w_.row_ + j) * w_.sy_;
  if (!left) {
    edgeY(i, j, i, j, 0.0, false, true);
    wall(i, j, i, j, false, 0.0, x0 - c_.x);
    sample(i, j + 1, i, j, 0.0, 1.0);
    if (!below && !w_.valid(i - 1, j - 1)) sample(i, j, i, j, 0.0, 0.0);
  }
  if (!below) {
    edgeX(i, j, i, j, 0.0, false, true);
    wall(i, j, i, j, true, 0.0, y0 - c_.y);
    if (!w_.valid(i + 1, j - 1)) sample(i + 1, j, i, j, 1.0, 0.0);
  }
  if (!w_.valid(i + 1, j)) wall(i, j, i + 1, j, false, 1.0, c_.x - (x0 + w_.sx_));
  if (!w_.valid(i, j + 1)) wall(i, j, i, j + 1, true, 1.0, c_.y - (y0 + w_.sy_));
}

void SphereWindow::Collector::cell(std::int32_t i, std::int32_t j) noexcept {
  if (!w_.valid(i, j)) return;
  const Corners z = w_.corners(i, j);
  if (!w_.whole_) [[unlikely]]
    rims(i, j);
  // The patch differs from its middle plane by at most a quarter of its twist.
  const double b = 0.5 * (z.z10 - z.z00 + z.z11 - z.z01);
  const double c = 0.5 * (z.z01 - z.z00 + z.z11 - z.z10);
  const double d = z.z11 - z.z10 - z.z01 + z.z00;
  const double p = b / w_.sx_;
  const double q = c / w_.sy_;
  const double middle = 0.25 * (z.z00 + z.z10 + z.z01 + z.z11);
  const double over = std::abs(c_.z - middle - p * (c_.x - (w_.column_ + i + 0.5) * w_.sx_) -
                               q * (c_.y - (w_.row_ + j + 0.5) * w_.sy_)) -
                      0.25 * std::abs(d);
  if (over > 0.0 && over * over > reach2_ * (1.0 + p * p + q * q) * (1.0 + 1e-9)) return;
  sample(i + 1, j + 1, i, j, 1.0, 1.0);
  edgeX(i, j + 1, i, j, 1.0, true, w_.valid(i, j + 1));
  edgeY(i + 1, j, i, j, 1.0, true, w_.valid(i + 1, j));
  inside(i, j, z);
}

// What cell() does for every cell within reach.
void SphereWindow::Collector::vectorised(std::int32_t i0, std::int32_t i1, std::int32_t j0,
                                         std::int32_t j1) noexcept {
  const SphereContactKernels& kernels = sphereContactKernels();
  const LaneWindow window = w_.laneWindow();
  const LaneProbe ball = laneProbe(c_, reach_, w_.sx_, w_.sy_);
  std::array<LaneCell, kMostLaneCells> cells;
  const int count = kernels.reached(window, w_.bounds_, ball, i0, i1, j0, j1, cells.data());
  LaneFinds finds;
  std::array<LaneCell, kSphereContactLanes> some;
  std::array<std::int8_t, kSphereContactLanes> lane;
  for (int from = 0; from < count; from += kSphereContactLanes) {
    const int here = std::min(count - from, kSphereContactLanes);
    int lanes = 0;
    unsigned left = 0;  // cells to look at
    for (int k = 0; k < here; ++k) {
      const LaneCell cell = cells[static_cast<std::size_t>(from + k)];
      const bool rim = w_.bounds_.rim[static_cast<std::size_t>(cell.j * w_.columns_ + cell.i)] != 0;
      lane[static_cast<std::size_t>(k)] = static_cast<std::int8_t>(rim ? -1 : lanes);
      left |= rim ? 1u << k : 0u;
      if (!rim) some[static_cast<std::size_t>(lanes++)] = cell;
    }
    unsigned found = 0;
    if (lanes > 0) {
      kernels.find(window, ball, some.data(), lanes, finds);
      found =
          finds.sample.found | finds.edge_x.found | finds.edge_y.found | finds.inside.found | finds.twisted;
    }
    if (lanes == here)
      left = found;
    else
      for (int k = 0; k < here; ++k)
        if (lane[static_cast<std::size_t>(k)] >= 0)
          left |= (found >> lane[static_cast<std::size_t>(k)] & 1u) << k;
    // In the order of cell(), which decides how ties are broken.
    for (; left != 0; left &= left - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(left));
      const LaneCell at = cells[static_cast<std::size_t>(from) + k];
      if (lane[k] < 0) {
        cell(at.i, at.j);
        continue;
      }
      const auto n = static_cast<std::size_t>(static_cast<unsigned char>(lane[k]));
      const auto take = [&](const LaneContacts& contacts, double u, double v) {
        if ((contacts.found >> n & 1u) != 0)
          add(at.i, at.j, u, v, {contacts.mx[n], contacts.my[n], contacts.mz[n]}, contacts.d2[n]);
      };
      take(finds.sample, 1.0, 1.0);
      take(finds.edge_x, finds.edge_x.u[n], 1.0);
      take(finds.edge_y, 1.0, finds.edge_y.v[n]);
      take(finds.inside, finds.inside.u[n], finds.inside.v[n]);
      if ((finds.twisted >> n & 1u) != 0) twisted(at.i, at.j);
    }
  }
}

void SphereWindow::Collector::candidates(const LaneCandidates& some) noexcept {
  const SphereContactKernels& kernels = sphereContactKernels();
  const LaneProbe ball = laneProbe(c_, reach_, w_.sx_, w_.sy_);
  LaneFinds finds;
  int insides = 0;
  for (int n = 0; n < some.count; ++n) {
    const LaneCandidate& at = some.cells[static_cast<std::size_t>(n)];
    const std::int32_t i = at.i;
    const std::int32_t j = at.j;
    if ((at.features & kRimFeature) != 0) {
      cell(i, j);
      continue;
    }
    if ((at.features & kSampleFeature) != 0) sample(i + 1, j + 1, i, j, 1.0, 1.0);
    if ((at.features & kEdgeXFeature) != 0) edgeX(i, j + 1, i, j, 1.0, true, true);
    if ((at.features & kEdgeYFeature) != 0) edgeY(i + 1, j, i, j, 1.0, true, true);
    if ((at.features & kInsideFeature) == 0) continue;
    const int lane = insides % kSphereContactLanes;
    if (lane == 0) kernels.insides(some, insides, w_.sx_, w_.sy_, ball, finds);
    ++insides;
    const auto k = static_cast<std::size_t>(lane);
    if ((finds.inside.found >> k & 1u) != 0)
      add(i, j, finds.inside.u[k], finds.inside.v[k],
          {finds.inside.mx[k], finds.inside.my[k], finds.inside.mz[k]}, finds.inside.d2[k]);
    if ((finds.twisted >> k & 1u) != 0) twisted(i, j);
  }
}

// A cell that may have several minima inside.
void SphereWindow::Collector::twisted(std::int32_t i, std::int32_t j) noexcept {
  const LaneWindow window = w_.laneWindow();
  const LaneProbe ball = laneProbe(c_, reach_, w_.sx_, w_.sy_);
  const LaneCell cell{static_cast<std::int16_t>(i), static_cast<std::int16_t>(j)};
  unsigned rises = sphereContactKernels().rises(window, ball, cell);
  if (rises == 0) return;
  Valley g(w_, c_, i, j, w_.corners(i, j));
  for (; rises != 0; rises &= rises - 1)
    if (g.mayHold(std::countr_zero(rises), reach2_)) minimumOfPiece(i, j, g, std::countr_zero(rises));
}

SphereWindow::Box SphereWindow::boxAround(const glm::dvec3& centre, double reach_mm) const noexcept {
  return {indexWithin((centre.x - reach_mm) / sx_ - column_, 0, columns_ - 2),
          indexWithin((centre.x + reach_mm) / sx_ - column_, 0, columns_ - 2),
          indexWithin((centre.y - reach_mm) / sy_ - row_, 0, rows_ - 2),
          indexWithin((centre.y + reach_mm) / sy_ - row_, 0, rows_ - 2)};
}

void SphereWindow::gather(const glm::dvec3& centre, double reach_mm, double room_mm) noexcept {
  gathered_at_ = centre;
  gathered_reach_ = reach_mm;
  gathered_room_ = room_mm;
  const double room = room_mm * (1.0 + 1e-5);  // far above rounding
  const Box box = boxAround(centre, reach_mm + room);
  gathered_ = boundable_ && sphereContactKernels().candidates(
                                laneWindow(), bounds_, laneProbe(centre, reach_mm + room, sx_, sy_), room,
                                box.i0, box.i1, box.j0, box.j1, candidates_);
}

// Gathering costs about one search. It pays when the next search is near: after two that were near each other,
// or while what was gathered before was used again.
void SphereWindow::contacts(const glm::dvec3& centre, double reach_mm, double room_mm,
                            SphereContactList& out) noexcept {
  const auto near = [&](const glm::dvec3& at) {
    const glm::dvec3 m = centre - at;
    return m.x * m.x + m.y * m.y + m.z * m.z <= room_mm * room_mm;
  };
  const bool near_last = near(searched_at_);
  searched_at_ = centre;
  if (gathered_ && gathered_reach_ == reach_mm && gathered_room_ == room_mm && near(gathered_at_)) {
    reused_ = true;
  } else if (near_last || reused_) {
    gather(centre, reach_mm, room_mm);
    reused_ = false;
  } else {
    gathered_ = false;
  }
  if (gathered_) {
    Collector(*this, centre, reach_mm, out).candidates(candidates_);
    return;
  }
  contactsSearched(centre, reach_mm, out);
}

void SphereWindow::contactsSearched(const glm::dvec3& centre, double reach_mm,
                                    SphereContactList& out) const noexcept {
  const Box box = boxAround(centre, reach_mm);
  Collector(*this, centre, reach_mm, out).vectorised(box.i0, box.i1, box.j0, box.j1);
}

void SphereWindow::contactsCellByCell(const glm::dvec3& centre, double reach_mm,
                                      SphereContactList& out) const noexcept {
  const double reach2 = reach_mm * reach_mm;
  const auto [i0, i1, j0, j1] = boxAround(centre, reach_mm);
  Collector collector(*this, centre, reach_mm, out);
  std::array<double, kMostSide> dx2;
  for (std::int32_t i = i0; i <= i1; ++i) {
    const double dx = beyond(centre.x, (column_ + i) * sx_, (column_ + i + 1) * sx_);
    dx2[static_cast<std::size_t>(i)] = dx * dx;
  }
  for (std::int32_t j = j0; j <= j1; ++j) {
    const double dy = beyond(centre.y, (row_ + j) * sy_, (row_ + j + 1) * sy_);
    const double left = reach2 - dy * dy;
    if (!(left > 0.0)) continue;
    const double* low = z_.data() + j * columns_;
    const double* high = low + columns_;
    double before = std::max(low[i0], high[i0]);
    for (std::int32_t i = i0; i <= i1; ++i) {
      // NaN may or may not pass through the maxima; cell() tests again.
      const double after = std::max(low[i + 1], high[i + 1]);
      const double gap = std::max(centre.z - std::max(before, after), 0.0);
      before = after;
      if (gap * gap + dx2[static_cast<std::size_t>(i)] < left) collector.cell(i, j);
    }
  }
}

}  // namespace fettle::haptic
