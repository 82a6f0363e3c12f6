#pragma once

#include <array>
#include <memory>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/field/live_field.h"
#include "engine/field/version.h"
#include "haptic/contact.h"
#include "haptic/scene.h"
#include "haptic/strokes.h"
#include "haptic/surface.h"
#include "haptic/tick_counters.h"

namespace fettle::haptic {

/// What effects see and change within one tick.
struct TickState {
  const Contact& contact;
  engine::LiveField& field;
  Surface& surface;
  TickCounters& counters;
  glm::dvec3 force_n{0.0};  ///< force effects add to it [N]; clamped before the tool acts
  double strength = 0.0;    ///< for tools: clamped force over limit, 0 .. 1
};

/// One effect as the tick calls it: a plain function and its data. noexcept is part of the type.
struct EffectStep {
  void (*run)(void* data, TickState& state) noexcept = nullptr;
  void* data = nullptr;
};

/// The effects of one scene, composed once: a list of force effects for every tick in contact, and one step a
/// tool. What the scene does not list is in neither, and its data does not exist.
///
/// A new effect is a file with an `add...` function below, a word in EffectKind, and a line in
/// composeEffects; the tick does not change.
struct EffectList {
  std::vector<EffectStep> forces;           ///< in the scene's order
  std::array<EffectStep, kTools> tools;     ///< by Tool; an empty step does nothing
  std::vector<std::shared_ptr<void>> data;  ///< what the steps point to
};

/// Builds what `scene` lists. `original` is what Scene::max_change is measured against, with the same way up
/// as the live field. May allocate; not for the haptic thread.
[[nodiscard]] EffectList composeEffects(const Scene& scene, const engine::Version& original);

void addSpring(EffectList& list, const Scene& scene);
void addSmoothing(EffectList& list, const Scene& scene, const engine::Version& original);
/// Marking is a tool of every scene, not an effect.
void addMarking(EffectList& list, const Scene& scene);

}  // namespace fettle::haptic
