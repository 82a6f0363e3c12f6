#include "haptic/effects/coupling.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace fettle::haptic {

namespace {

struct Coupling {
  double damping_n_s_per_mm;

  static void run(void* data, TickState& state) noexcept {
    const double press = glm::length(state.press_n);
    if (!(press > 0.0 && std::isfinite(press))) return;
    const glm::dvec3 normal = state.press_n / press;
    const double damping = static_cast<const Coupling*>(data)->damping_n_s_per_mm;
    const double along_n = -damping * glm::dot(state.motion->mmPerS(), normal);
    state.force_n += std::max(along_n, -press) * normal;
  }
};

}  // namespace

void addCoupling(EffectList& list, const EffectSource& from) {
  Coupling& coupling =
      addData(list, EffectKind::kCoupling,
              std::make_shared<Coupling>(Coupling{from.scene.params.coupling.damping_n_s_per_mm}));
  list.in_contact.push_back({&Coupling::run, &coupling});
  needMotion(list, from.scene);
}

}  // namespace fettle::haptic
