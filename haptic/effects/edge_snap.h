#pragma once

#include <algorithm>

#include <glm/vec2.hpp>

#include "haptic/effects/effect.h"
#include "haptic/effects/mark_distance.h"

namespace fettle::haptic {

/// Edge snap: while the tip touches, a horizontal pull towards the nearest sample that is marked or that an edge line
/// passes, for tracing edges that are marked already. With r the horizontal distance to it, F the largest pull and R the reach:
///   pull(r) = 4 F (r / R) (1 - r / R),   the slope of   U(r) = -2 F R / 3 (1 - r / R)^2 (1 + 2 r / R)
/// zero on the edge, F halfway, zero at the reach and beyond, where U is zero. Between samples U
/// is the quadratic B-spline whose coefficients are its values at the samples (Unser, "Splines: a perfect fit
/// for signal and image processing", 1999), and the force its exact gradient: conservative, and continuous
/// everywhere, in cusps between two edges too.
///
/// The pull rises over 50 ms after the tip touched, so that touching down near an edge causes no jump of
/// force; it gives the hand at most 2 F R / 3 mJ each time (passivity, if listed, removes that).
/// Marks added or removed, by the user or by another version, change the pull after bounded work per tick:
/// see MarkDistance. If the pull changes under the tip meanwhile, it does by F at most.
///
/// Sources: attraction by a potential, Khatib, "Real-time obstacle avoidance for manipulators and mobile
/// robots" (1986), of which snapping is the opposite sign; guidance along edges as virtual fixtures,
/// Rosenberg, "Virtual fixtures" (1993).
/// Stability: restoring stiffness is at most 4 F / R along any sample row or column (a minimum of functions
/// curves upwards no more than they do, and a B-spline's second differences are averages of theirs): across
/// the edge b > T / 2 * 4 F / R, together with the other stiffness along the surface (friction). R is the reach that there is,
/// MarkDistance::reachMm(): a fine field cuts that of the scene, and the pull is stiffer.
/// Cost: nine distances, some 60 multiplications, and up to one slice of MarkDistance. Memory: MarkDistance.
class EdgeSnap {
 public:
  /// The potential and its slope.
  struct Potential {
    double mj = 0.0;        ///< -2 F R / 3 .. 0 [N mm]
    glm::dvec2 slope{0.0};  ///< [N]
  };

  EdgeSnap(const EdgeSnapParams& params, const engine::FieldReader& reader, const engine::LineCuts* lines);

  /// At a point over the field (outside it: finite).
  [[nodiscard]] Potential at(double x_mm, double y_mm) const noexcept;
  void run(TickState& state) noexcept;
  void upkeep(TickState& state) noexcept;
  void reset(ResetCause why) noexcept;

  [[nodiscard]] const MarkDistance& distance() const noexcept { return distance_; }
  /// U of a distance [N mm].
  [[nodiscard]] double potentialOf(double distance_mm) const noexcept {
    const double q = std::min(distance_mm / distance_.reachMm(), 1.0);
    return -deepest_mj_ * (1.0 - q) * (1.0 - q) * (1.0 + 2.0 * q);
  }

 private:
  MarkDistance distance_;
  double sx_, sy_;
  std::int32_t width_, height_;
  double deepest_mj_;  // 2 F R / 3
  double touched_s_ = 0.0;
  bool touching_ = false;
};

AddEffect addEdgeSnap;

}  // namespace fettle::haptic
