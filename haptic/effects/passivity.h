#pragma once

#include <glm/vec3.hpp>

#include "haptic/effects/effect.h"

namespace fettle::haptic {

/// Passivity observer and controller: the applied forces return no more energy than was put in.
///
/// Observer. A force is held from one tick to the next, so its work on the hand meanwhile is known exactly: W
/// += F' . (x - x'), F' the last force, after the clamp, without gravity compensation (the stylus' weight
/// does the opposite work). W > 0: more came out than went in. Energy put in counts only as long as it can be
/// stored (spring, stuck friction, snap: TickState::stored_mj); dissipated energy is no credit for later: W
/// >= -stored. In free space nothing is stored.
///
/// Controller. If W would be above zero at the next tick, with the hand moving as since the last, the part of
/// the force along the motion is lowered until it would not: first the driving part is removed, which is
/// always safe, then the hand is damped, with at most b of damping. Never changes the force perpendicular to
/// the motion; |F| stays within the limit. The error of the forecast by acceleration within one tick is seen
/// one tick later and removed: at most about F_max (F_max + F_hand) T^2 / m is unaccounted at any time.
///
/// Sources: Hannaford and Ryu, "Time-domain passivity control of haptic interfaces" (2002): observer,
/// series damper; Ryu, Kim, Hannaford, "Stability control of haptic interfaces with reference energy" (2004):
/// the observer's bound is the energy that may be stored instead of zero.
/// Jumps of the position, gaps above 20 ms and samples without time (VelocityFilter) are not counted.
/// Stability: the controller is a sampled damper, b < 2 m / T (see viscosity.cpp); removing force needs no
/// bound. What comes after the tick (ForceGuard) only lowers forces; while it does, the observer counts with
/// more force than was applied.
/// Cost: about 20 multiplications, a square root in ticks where it acts. State: force, position, W.
class Passivity {
 public:
  explicit Passivity(const PassivityParams& params) noexcept : brake_(params.max_damping_n_s_per_mm) {}

  void run(TickState& state) noexcept;
  /// No input: no force was applied, so the motion of the hand is not counted.
  void inputLost() noexcept { known_ = false; }

 private:
  double brake_;
  glm::dvec3 given_n_{0.0};
  glm::dvec3 at_mm_{0.0};
  double balance_mj_ = 0.0;  // W
  bool known_ = false;
};

AddEffect addPassivity;

}  // namespace fettle::haptic
