#include "haptic/effects/effect.h"

#include "engine/base/rows.h"
#include "haptic/effects/edge_snap.h"
#include "haptic/effects/friction.h"
#include "haptic/effects/passivity.h"
#include "haptic/effects/texture.h"

namespace fettle::haptic {

// In spring.cpp, coupling.cpp, viscosity.cpp, gravity.cpp, sound.cpp; in haptic/tick.
AddEffect addSpring, addCoupling, addViscosity, addGravity, addSound, addSmoothing, addMarking;

namespace {

struct EffectEntry {
  EffectKind kind;
  AddEffect* add;
};
constexpr EffectEntry kEffects[] = {
    {EffectKind::kSpring, addSpring},       {EffectKind::kSmoothing, addSmoothing},
    {EffectKind::kFriction, addFriction},   {EffectKind::kViscosity, addViscosity},
    {EffectKind::kEdgeSnap, addEdgeSnap},   {EffectKind::kTexture, addTexture},
    {EffectKind::kGravity, addGravity},     {EffectKind::kCoupling, addCoupling},
    {EffectKind::kPassivity, addPassivity}, {EffectKind::kSound, addSound},
};
static_assert(engine::inOrder(kEffects, &EffectEntry::kind, EffectKind::kCount));

constexpr AddEffect* kToolsOfEveryScene[] = {addMarking};

}  // namespace

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
  const VelocityParams& velocity = scene.params.velocity;
  if (!list.motion) list.motion.emplace(1e-3 * velocity.filter_ms, velocity.fastest_mm_per_s);
}

EffectList composeEffects(const Scene& scene, const engine::Version& original, const engine::Version& now) {
  EffectList list;
  const EffectSource from{scene, original, now};
  for (const EffectKind kind : scene.effects) kEffects[static_cast<std::size_t>(kind)].add(list, from);
  for (AddEffect* const add : kToolsOfEveryScene) add(list, from);
  return list;
}

}  // namespace fettle::haptic
