#pragma once

#include <glm/vec3.hpp>

#include "haptic/effects/effect.h"

namespace fettle::haptic {

/// Passivity observer and controller: what is felt gives back no more energy than was put into it.
///
/// Observer. A force is held from one tick to the next, so what it did on the hand meanwhile is known
/// exactly: W += F' . (x - x'), F' the force given last, after the clamp, without gravity compensation (whose
/// work the stylus' weight takes back). W > 0: more came out than went in. Energy put in counts only as long
/// as it can be stored (spring, stuck friction, snap: TickState::stored_mj); what was dissipated is no credit
/// for later: W >= -stored. In free space nothing is stored.
///
/// Controller. Would W be above zero at the next tick, if the hand went on as it went since the last? Then
/// the part of the force along the motion is lowered until it would not: first the driving part is taken
/// away, which is always safe, then the hand is braked, with at most b of damping. Never turns the force
/// across the motion; |F| stays within the limit. What acceleration within one tick makes of the forecast is
/// seen one tick later and taken back: at most about F_max (F_max + F_hand) T^2 / m is out at any time.
///
/// Sources: Hannaford and Ryu, "Time-domain passivity control of haptic interfaces" (2002): observer,
/// series damper; Ryu, Kim, Hannaford, "Stability control of haptic interfaces with reference energy" (2004):
/// observing against what may be stored instead of against zero.
/// Jumps of the position, gaps above 20 ms and samples without time (VelocityFilter) are not counted.
/// Stability: the brake is a sampled damper, b < 2 m / T (see viscosity.h); taking force away needs no bound.
/// What comes after the tick (ForceGuard) only lowers forces; while it does, the observer counts with more
/// than was given.
/// Cost: some 20 multiplications, a square root in ticks where it acts. State: force, position, W.
class Passivity {
 public:
  explicit Passivity(const PassivityParams& params) noexcept : brake_(params.max_damping_n_s_per_mm) {}

  void run(TickState& state) noexcept;
  /// No input: no force was given, and the way the hand goes without it is nothing to count.
  void inputLost() noexcept { known_ = false; }

  /// W [N mm], within [-stored, small].
  [[nodiscard]] double balanceMj() const noexcept { return balance_mj_; }

 private:
  double brake_;
  glm::dvec3 given_n_{0.0};
  glm::dvec3 at_mm_{0.0};
  double balance_mj_ = 0.0;  // W
  bool known_ = false;
};

void addPassivity(EffectList& list, const Scene& scene);

}  // namespace fettle::haptic
