#include "haptic/effects/spring.h"

#include <glm/geometric.hpp>

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

void addSpring(EffectList& list, const EffectSource& from) {
  Spring& spring =
      addData(list, EffectKind::kSpring, std::make_shared<Spring>(Spring{from.scene.stiffness_n_per_mm}));
  list.in_contact.push_back({&Spring::run, &spring});
}

}  // namespace fettle::haptic
