#include "haptic/contact/sphere_collector.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "haptic/contact/sphere_valley.h"

namespace fettle::haptic {

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
  keepMinimum(i, j, g, v);
}

void SphereWindow::Collector::keepMinimum(std::int32_t i, std::int32_t j, Valley& g, double v) noexcept {
  if (!(g.u > 0.0 && g.u < 1.0 && v > 0.0 && v < 1.0 && g.height < 0.0)) return;
  const glm::dvec3 m{g.ex - g.u * g.sx, g.ey - v * g.sy, -g.height};
  const double d2 = m.x * m.x + m.y * m.y + m.z * m.z;
  if (d2 < reach2_) add(i, j, g.u, v, m, d2);
}

void SphereWindow::Collector::minimumOfPiece(std::int32_t i, std::int32_t j, Valley& g, int piece) noexcept {
  minimum(i, j, g, static_cast<double>(piece) / kTwistPieces, (piece + 1.0) / kTwistPieces,
          (piece + 0.5) / kTwistPieces);
}

// Newton's method in a bracket whose places differ by decades: to a part of the scale there.
void SphereWindow::Collector::steepMinimum(std::int32_t i, std::int32_t j, Valley& g, double low,
                                           double high) noexcept {
  double v = 0.5 * (low + high);
  for (int round = 0; round < 60; ++round) {
    const double slope = g.steepSlopeAt(v);
    (slope < 0.0 ? low : high) = v;
    const double next = g.bend > 0.0 ? v - slope / g.bend : -1.0;
    const double to = next > low && next < high ? next : 0.5 * (low + high);
    const double moved = std::abs(to - v);
    v = to;
    if (moved <= 1e-9 * g.scaleAt(v)) break;
  }
  (void)g.steepSlopeAt(v);
  keepMinimum(i, j, g, v);
}

// All minima of a cell that is steep(). Pieces are in proportion to the scale of g; where its slope has the same sign at
// both ends of one and turns between them, the place where it turns decides whether there are two roots. Bounded, what
// holds no minimum within reach is left out and several pieces are looked at at a time: the same bits.
//
// A valley is some spacing / twist of a cell wide. Where that is less than the places along a cell differ by, no number of
// pieces finds it, and some 250 pieces of every cell around the ball would be searched for minima among roundings, 20 ms a
// tick. Scans hold such heights where 3.4e38 stands for a hole that the file does not declare.
void SphereWindow::Collector::steep(std::int32_t i, std::int32_t j, Valley& g, SphereSearch search) noexcept {
  if (w_.tooNarrow(g.d)) return;
  constexpr int kPieces = kSphereContactLanes;
  constexpr int kBlock = 4 * kPieces;
  const Valley::Pieces pieces(g);
  const SphereContactKernels& kernels = sphereContactKernels();
  const LaneValley lanes = g.lanes();
  const bool bounded = search == SphereSearch::kBounded;
  const auto mayHold = [&](double v0, double v1) { return !bounded || g.mayHold(v0, v1, reach2_); };
  const auto endAt = [&](double v) { return PieceEnd{v, g.steepSlopeAt(v), g.bend}; };
  std::array<double, kBlock + kPieces> v;
  std::array<double, kPieces> slope;
  std::array<double, kPieces> bend;
  // Slopes are taken where a minimum within reach may be: most pieces of a needle are out of it.
  PieceEnd from{0.0, 0.0, 0.0};
  bool known = false;  // its slope and bend
  while (from.v < 1.0 && mayHold(from.v, 1.0)) {
    int count = 0;
    for (double end = from.v; count < kBlock && end < 1.0; ++count)
      v[static_cast<std::size_t>(count)] = end = pieces.end(end);
    std::fill_n(v.begin() + count, kPieces, 1.0);
    const bool block_holds = mayHold(from.v, v[static_cast<std::size_t>(count - 1)]);
    for (int at = 0; at < count; at += kPieces) {
      const auto first = static_cast<std::size_t>(at);
      const auto some = static_cast<std::size_t>(std::min(kPieces, count - at));
      const double last = v[first + some - 1];
      if (!block_holds || !mayHold(from.v, last)) {
        from.v = last;
        known = false;
        continue;
      }
      if (!known) from = endAt(from.v);
      known = true;
      if (bounded) kernels.steepSlopes(lanes, v.data() + first, slope.data(), bend.data());
      for (std::size_t k = 0; k < some; ++k) {
        const PieceEnd to = bounded ? PieceEnd{v[first + k], slope[k], bend[k]} : endAt(v[first + k]);
        steepPiece(i, j, g, from, to, search);
        from = to;
      }
    }
  }
}

void SphereWindow::Collector::steepPiece(std::int32_t i, std::int32_t j, Valley& g, const PieceEnd& from,
                                         const PieceEnd& to, SphereSearch search) noexcept {
  const auto outOfReach = [&] {
    return search == SphereSearch::kBounded && !g.mayHold(from.v, to.v, reach2_);
  };
  if (from.slope < 0.0 && to.slope > 0.0) {
    if (outOfReach()) return;
    steepMinimum(i, j, g, from.v, to.v);
    return;
  }
  const bool turns = from.slope < 0.0 ? to.slope < 0.0 && from.bend > 0.0 && to.bend < 0.0
                                      : to.slope > 0.0 && from.bend < 0.0 && to.bend > 0.0;
  if (!turns || outOfReach()) return;
  // A root with a rising slope is before the turn where the slope is below zero at the ends, else behind it.
  const bool below = from.slope < 0.0;
  double low = from.v;
  double high = to.v;
  for (int round = 0; round < 40; ++round) {
    const double middle = 0.5 * (low + high);
    const double slope = g.steepSlopeAt(middle);
    if (below ? slope > 0.0 : slope < 0.0) {
      steepMinimum(i, j, g, below ? from.v : middle, below ? middle : to.v);
      return;
    }
    ((g.bend > 0.0) == below ? low : high) = middle;
  }
}

void SphereWindow::Collector::inside(std::int32_t i, std::int32_t j, const Corners& z,
                                     SphereSearch search) noexcept {
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
  if (search == SphereSearch::kBounded) {
    twisted(i, j);
    return;
  }
  if (w_.steep(g.d)) {
    steep(i, j, g, SphereSearch::kCellByCell);
    return;
  }
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

void SphereWindow::Collector::cell(std::int32_t i, std::int32_t j, SphereSearch search) noexcept {
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
  inside(i, j, z, search);
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
        cell(at.i, at.j, SphereSearch::kBounded);
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
      cell(i, j, SphereSearch::kBounded);
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
  Valley g(w_, c_, i, j, w_.corners(i, j));
  if (w_.steep(g.d)) {
    steep(i, j, g, SphereSearch::kBounded);
    return;
  }
  for (unsigned rises = sphereContactKernels().rises(g.lanes()); rises != 0; rises &= rises - 1)
    if (g.mayHold(std::countr_zero(rises), reach2_)) minimumOfPiece(i, j, g, std::countr_zero(rises));
}

}  // namespace fettle::haptic
