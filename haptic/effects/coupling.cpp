#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "haptic/effects/effect.h"

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

// Virtual coupling: with the spring, a damper between proxy and endpoint along the direction in which the
// surface presses, F = -b (v . n) n. The proxy of a surface at rest moves across n, so this is the rate of
// the penetration; taken from the endpoint and not from the penetration, because the penetration jumps where
// an edit or a corner moves the proxy. Never pulls: spring and damper together are at least zero, so that
// the surface is not sticky.
//
// Sources: Colgate, Stanley, Brown, "Issues in the haptic display of tool use" (1995); Adams and Hannaford,
// "Stable haptic interaction with virtual environments" (1999).
// Stability: against a device of mass m, b < 2 m / T (see viscosity.cpp). With wall K and filter weight
// a = T / (T + tau) passive while b_device > K T / 2 + b a / (2 - a). That is more than a mass needs: stable
// means b_device + b above K T / 2 plus what the damper's own delay removes from b. Its test reaches both
// limits, too little damping and 2 m / T. No state of its own. Cost: ten multiplications and the velocity
// filter's.
void addCoupling(EffectList& list, const EffectSource& from) {
  Coupling& coupling =
      addData(list, EffectKind::kCoupling,
              std::make_shared<Coupling>(Coupling{from.scene.params.coupling.damping_n_s_per_mm}));
  list.in_contact.push_back({&Coupling::run, &coupling});
  needMotion(list, from.scene);
}

}  // namespace fettle::haptic
