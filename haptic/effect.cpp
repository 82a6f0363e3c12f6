#include "haptic/effect.h"

namespace fettle::haptic {

namespace {

struct Spring {
  double stiffness_n_per_mm;

  static void run(void* data, TickState& state) noexcept {
    state.force_n += static_cast<const Spring*>(data)->stiffness_n_per_mm * state.contact.penetration_mm;
  }
};

}  // namespace

void addSpring(EffectList& list, const Scene& scene) {
  auto spring = std::make_shared<Spring>(Spring{scene.stiffness_n_per_mm});
  list.forces.push_back({&Spring::run, spring.get()});
  list.data.push_back(std::move(spring));
}

EffectList composeEffects(const Scene& scene, const engine::Version& original) {
  EffectList list;
  for (const EffectKind kind : scene.effects) {
    switch (kind) {
      case EffectKind::kSpring:
        addSpring(list, scene);
        break;
      case EffectKind::kSmoothing:
        addSmoothing(list, scene, original);
        break;
    }
  }
  addMarking(list, scene);
  return list;
}

}  // namespace fettle::haptic
