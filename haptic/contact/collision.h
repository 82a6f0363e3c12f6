#pragma once

#include <glm/vec3.hpp>

#include "haptic/contact/surface.h"

namespace fettle::haptic {

/// A cell that the haptic ray may touch, and the part of the ray above it: from + t (to - from).
struct RayCell {
  CellIndex cell;
  double enter = 0.0, leave = 1.0;  ///< t, 0 <= enter <= leave <= 1
};

/// Walks the cells under a haptic ray, in the ray's order, and stops at those it may touch: cells without
/// holes whose highest point is not below the lowest point of the ray above them. That bound is the cell's
/// own part of the ray rather than the whole ray's minimum: both are free of misses, but with the whole ray's
/// a tip that clears a ridge would start its search on the ridge's near face and be held there. Squares of 8,
/// 64, 512 ... cells that the ray clears are crossed in one step by the max pyramid.
///
/// Sources: Amanatides and Woo 1987 (grid walk); Potter, Johnson, Cohen, DETC2004-57539, figure 2 (the
/// bound). Guarantee: noexcept, allocates nothing, at most kMaxSteps steps in all; stoppedByBound() says so.
class RayWalk {
 public:
  /// Steps of one walk, cells and squares together: 10 m of cleared field, or 200 mm of cells at 0.05 mm.
  static constexpr int kMaxSteps = 4096;

  /// Points may lie anywhere; all coordinates finite. The ray is cut to the field's cells.
  RayWalk(Surface& surface, const glm::dvec3& from, const glm::dvec3& to) noexcept;

  /// The next cell that may be touched; false when the ray has left the field or ended.
  [[nodiscard]] bool next(RayCell& out) noexcept;

  [[nodiscard]] bool stoppedByBound() const noexcept { return steps_ >= kMaxSteps; }

 private:
  struct Exit {
    double x = HUGE_VAL, y = HUGE_VAL;  // t at the square's sides; HUGE_VAL where the ray runs along them
  };
  [[nodiscard]] Exit exitOf(int shift) const noexcept;
  [[nodiscard]] double leaveAt(const Exit& exit) const noexcept;
  void step(int shift, const Exit& exit, double leave) noexcept;
  [[nodiscard]] double lowest(double enter, double leave) const noexcept;
  [[nodiscard]] bool clears(int level, double ray_low) const noexcept;

  Surface& surface_;
  double gx_, gy_, dx_, dy_;  // origin and direction [cells]
  double z_, dz_, slack_;     // height along the ray [mm] and what rounding may do to it
  double at_ = 0.0, end_ = 0.0;
  CellIndex cell_;
  int level_ = -1;  // square size tried next: -1 the cell itself, 0 a block of 8, ...
  int steps_ = 0;
  bool done_ = true;
};

/// Whether the ray comes down through the patch within [enter, leave]: at or above it at first, below it
/// later. Exact but for rounding: height above a bilinear patch is quadratic along a ray.
[[nodiscard]] bool entersPatch(const Patch& patch, const glm::dvec3& from, const glm::dvec3& to, double enter,
                               double leave) noexcept;

}  // namespace fettle::haptic
