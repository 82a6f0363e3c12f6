#include "haptic/effects/effect.h"

namespace fettle::haptic {

namespace {

constexpr double kStandardGravity = 9.80665;  // [m/s^2]

struct Gravity {
  double weight_n;

  static void run(void* data, TickState& state) noexcept {
    const double weight_n = static_cast<const Gravity*>(data)->weight_n;
    state.weight_n.z += weight_n;
    state.force_n.z += weight_n;
  }
};

}  // namespace

// Holds up the stylus: F = +m g along z, 9.80665 m/s^2, in contact and in free space, as long as there is
// input. The clamp is on the sum of all forces, so a heavy stylus leaves less for the surface. The passivity
// observer ignores it: the stylus' weight does the opposite work on the hand.
//
// Source: gravity compensation by a model of the arm, e.g. Craig, "Introduction to Robotics" (2005), section
// 10.4, here of a point mass at the tip.
// Stability: a constant force closes no loop. The stylus must weigh at least that much, otherwise it rises.
// Cost: one addition.
void addGravity(EffectList& list, const EffectSource& from) {
  const double weight_n = from.scene.params.gravity.stylus_kg * kStandardGravity;
  Gravity& gravity = addData(list, EffectKind::kGravity, std::make_shared<Gravity>(Gravity{weight_n}));
  list.always.push_back({&Gravity::run, &gravity});
}

}  // namespace fettle::haptic
