#pragma once

#include <glm/vec3.hpp>

#include "haptic/effects/effect.h"

namespace fettle::haptic {

/// Coulomb friction with stick-slip, as a spring between the endpoint and an anchor fixed to the surface.
///
///   N = min(|press|, force limit)          strain s = tangential part of (endpoint - anchor)
///   sticking: F = -k s                     while k |s| <= static N, else it slips
///   slipping: the anchor is dragged so that k |s| = dynamic N;
///             sticks again when the strain fell below half of that (the hand turned back), or when it was
///             at most that for 20 ms (the hand came to rest)
///
/// "Tangential" is perpendicular to the direction in which the surface presses, which is defined at edges and
/// corners too. As the surface's direction changes under the tip, the anchor is moved along that direction
/// only.
///
/// Energy. The spring stores k s^2 / 2, and every change of the anchor makes s shorter. For any motion and
/// any sequence of normals, s' = P(s + dx) with P the projection across the normal, so that
///   work on the hand = -k s' . dx <= k s^2 / 2 - k s'^2 / 2:
/// no more energy comes out than was put in, when the force is that at the end of the step. Held over the
/// next sample, as every sampled force is, it needs the condition below. The cost of passivity: where normals
/// differ from tick to tick, the anchor of a trembling hand moves by the tremor times the sine of the angle.
/// On a plane it does not drift: the anchor stays within rounding.
///
/// Sources: Salisbury, Brock, Massie, Swarup, Zilles, "Haptic rendering: programming touch interaction with
/// virtual objects" (1995): stick point, break-away by the static coefficient. Hayward and Armstrong, "A new
/// computational model of friction applied to haptic rendering" (2000): the anchor is moved by position
/// alone, without velocity and so without drift.
/// Stability: the stuck tip is a wall of stiffness k along the surface: b > k T / 2 (see spring.cpp).
/// Cost: about 30 multiplications per tick in contact. State: an anchor.
class Friction {
 public:
  Friction(const FrictionParams& params) noexcept;

  void run(TickState& state) noexcept;
  /// Discards the anchor: the next tick has no strain, so the force does not jump.
  void reset() noexcept { anchored_ = false; }

  [[nodiscard]] bool slipping() const noexcept { return slipping_; }
  [[nodiscard]] const glm::dvec3& anchorMm() const noexcept { return anchor_mm_; }

 private:
  double static_, dynamic_, stiffness_;
  glm::dvec3 anchor_mm_{0.0};
  double slip_t_s_ = 0.0;  // when it last slipped
  bool anchored_ = false;
  bool slipping_ = false;
};

AddEffect addFriction;

}  // namespace fettle::haptic
