#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>

#include "haptic/contact/sphere_contact_lanes.h"
#include "haptic/contact/sphere_window.h"

namespace fettle::haptic {

/// Of two cells at least one must report a contact on their common side: the relative rounding allowed in that
/// comparison. A contact reported twice does no harm, both are the same.
inline constexpr double kSphereSeam = 1e-10;

/// The ball as the lanes read it; reach and spacings [mm].
[[nodiscard]] inline LaneProbe laneProbe(const glm::dvec3& centre, double reach, double sx,
                                         double sy) noexcept {
  return {
      centre.x, centre.y, centre.z, reach, reach * reach, kSphereSeam * reach * sx, kSphereSeam * reach * sy};
}

/// One search for contacts in a window, cell by cell or several at a time: everything relative to the centre. The order
/// of cells and of the kinds of contact is the same in each way, which decides how ties are broken.
class SphereWindow::Collector {
 public:
  Collector(const SphereWindow& window, const glm::dvec3& centre, double reach,
            SphereContactList& out) noexcept
      : w_(window),
        c_(centre),
        reach_(reach),
        reach2_(reach * reach),
        seam_x_(kSphereSeam * reach * window.sx_),
        seam_y_(kSphereSeam * reach * window.sy_),
        out_(out) {
    out.count = 0;
    out.nearest_mm = HUGE_VAL;
  }

  void cell(std::int32_t i, std::int32_t j, SphereSearch search) noexcept;
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
  void keepMinimum(std::int32_t i, std::int32_t j, Valley& g, double v) noexcept;
  void steepMinimum(std::int32_t i, std::int32_t j, Valley& g, double low, double high) noexcept;
  void steep(std::int32_t i, std::int32_t j, Valley& g, SphereSearch search) noexcept;
  struct PieceEnd {
    double v, slope, bend;
  };
  void steepPiece(std::int32_t i, std::int32_t j, Valley& g, const PieceEnd& from, const PieceEnd& to,
                  SphereSearch search) noexcept;
  void minimumOfPiece(std::int32_t i, std::int32_t j, Valley& g, int piece) noexcept;
  void inside(std::int32_t i, std::int32_t j, const Corners& z, SphereSearch search) noexcept;
  void twisted(std::int32_t i, std::int32_t j) noexcept;
  void rims(std::int32_t i, std::int32_t j) noexcept;

  const SphereWindow& w_;
  glm::dvec3 c_;
  double reach_, reach2_, seam_x_, seam_y_;
  SphereContactList& out_;
};

}  // namespace fettle::haptic
