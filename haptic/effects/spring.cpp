#include <glm/geometric.hpp>

#include "haptic/effects/effect.h"

namespace fettle::haptic {

namespace {

struct Spring {
  double stiffness_n_per_mm;

  static void run(void* data, TickState& state) noexcept {
    const glm::dvec3 press =
        static_cast<const Spring*>(data)->stiffness_n_per_mm * state.contact.penetration_mm;
    state.press_n += press;
    state.force_n += press;
    state.stored_mj += 0.5 * glm::dot(press, state.contact.penetration_mm);
  }
};

}  // namespace

// Spring contact: F = K (proxy - endpoint), K = Scene::stiffness_n_per_mm.
//
// Source: Potter, Johnson, Cohen, DETC2004-57539, "Haptic Rendering" (force from the proxy along the
// penetration vector); the proxy itself after Zilles and Salisbury, "A constraint-based god-object method
// for haptic display" (1995).
// Stability: sampled every T seconds and held, a wall of stiffness K feeds energy to a hand unless the
// device damps b > K T / 2 (Colgate and Schenkel, "Passivity of a class of sampled-data systems", 1994/1997;
// Colgate and Brown 1994). It is exact for a mass on the wall in the limit of a slow oscillation;
// bench/stiffness_sweep measures it.
// No state. Cost: three multiplications and additions.
void addSpring(EffectList& list, const EffectSource& from) {
  Spring& spring =
      addData(list, EffectKind::kSpring, std::make_shared<Spring>(Spring{from.scene.stiffness_n_per_mm}));
  list.in_contact.push_back({&Spring::run, &spring});
}

}  // namespace fettle::haptic
