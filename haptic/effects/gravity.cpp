#include "haptic/effects/gravity.h"

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

void addGravity(EffectList& list, const EffectSource& from) {
  const double weight_n = from.scene.params.gravity.stylus_kg * kStandardGravity;
  Gravity& gravity = addData(list, EffectKind::kGravity, std::make_shared<Gravity>(Gravity{weight_n}));
  list.always.push_back({&Gravity::run, &gravity});
}

}  // namespace fettle::haptic
