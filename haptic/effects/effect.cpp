#include "haptic/effects/effect.h"

#include "haptic/effects/coupling.h"
#include "haptic/effects/edge_snap.h"
#include "haptic/effects/friction.h"
#include "haptic/effects/gravity.h"
#include "haptic/effects/passivity.h"
#include "haptic/effects/spring.h"
#include "haptic/effects/texture.h"
#include "haptic/effects/viscosity.h"

namespace fettle::haptic {

std::size_t EffectList::bytesOf(EffectKind kind) const noexcept {
  std::size_t sum = 0;
  for (const EffectData& entry : data) sum += entry.kind == kind ? entry.bytes : 0;
  return sum;
}

std::size_t EffectList::bytes() const noexcept {
  std::size_t sum = 0;
  for (const EffectData& entry : data) sum += entry.bytes;
  return sum;
}

void needMotion(EffectList& list, const Scene& scene) {
  if (!list.motion) list.motion.emplace(1e-3 * scene.params.velocity.filter_ms);
}

EffectList composeEffects(const Scene& scene, const engine::Version& original, const engine::Version& now) {
  EffectList list;
  for (const EffectKind kind : scene.effects) {
    switch (kind) {
      case EffectKind::kSpring:
        addSpring(list, scene);
        break;
      case EffectKind::kSmoothing:
        addSmoothing(list, scene, original);
        break;
      case EffectKind::kFriction:
        addFriction(list, scene);
        break;
      case EffectKind::kViscosity:
        addViscosity(list, scene);
        break;
      case EffectKind::kGravity:
        addGravity(list, scene);
        break;
      case EffectKind::kCoupling:
        addCoupling(list, scene);
        break;
      case EffectKind::kEdgeSnap:
        addEdgeSnap(list, scene, now);
        break;
      case EffectKind::kTexture:
        addTexture(list, scene);
        break;
      case EffectKind::kPassivity:
        addPassivity(list, scene);
        break;
    }
  }
  addMarking(list, scene);
  return list;
}

}  // namespace fettle::haptic
