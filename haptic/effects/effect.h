#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/field/live_field.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"
#include "haptic/base/sound_tick.h"
#include "haptic/base/strokes.h"
#include "haptic/base/tick_counters.h"
#include "haptic/contact/contact.h"
#include "haptic/contact/surface.h"
#include "haptic/effects/velocity.h"
#include "haptic/scene/scene.h"

namespace fettle::haptic {

/// What effects read and change within one tick.
struct TickState {
  const Contact& contact;
  engine::LiveField& field;
  Surface& surface;
  TickCounters& counters;
  double t_s = 0.0;                        ///< of the sample
  glm::dvec3 endpoint_mm{0.0};             ///< finite
  const VelocityFilter* motion = nullptr;  ///< of the endpoint; null when no effect of the scene needs it
  double force_limit_n = 0.0;              ///< of the scene

  glm::dvec3 force_n{0.0};   ///< force effects add to it [N]; clamped before finishing effects and tools
  glm::dvec3 press_n{0.0};   ///< part of it with which the tip presses on the surface (spring) [N]
  glm::dvec3 weight_n{0.0};  ///< part of it that only holds up the stylus [N]
  double stored_mj = 0.0;    ///< energy that the forces so far can give back [N mm], at most
  double strength = 0.0;     ///< for tools: pressing force over limit, 0 .. 1
  bool slipping = false;     ///< set by friction: the tip slides
  double released_n =
      0.0;  ///< set by friction: by how much it fell as the tip began to slip in this tick [N]
  /// Samples whose marks a tool may have changed, set by the marking tools; may reach beyond the field.
  engine::SampleRect marked{};
};

/// Why an effect is reset.
enum class ResetCause : std::uint8_t {
  kContactEnded,  ///< the tip left the surface
  kInputLost,     ///< invalid input: zero force was applied, and the motion of the hand is unknown
  kFieldChanged,  ///< the field was replaced from outside (adoption, undo, scene)
};

class TextureTable;

/// One effect as the tick calls it: a plain function and its data. noexcept is part of the type.
struct EffectStep {
  void (*run)(void* data, TickState& state) noexcept = nullptr;
  void* data = nullptr;
};

/// How an effect resets its state. None may raise the force.
struct EffectReset {
  void (*run)(void* data, ResetCause why) noexcept = nullptr;
  void* data = nullptr;
};

/// Data of one effect.
struct EffectData {
  EffectKind kind = EffectKind::kSpring;
  std::shared_ptr<void> memory;
  std::size_t bytes = 0;  ///< the object and the memory it owns
};

/// The effects of one scene, composed once. A tick calls, each list in the scene's order:
///
///   contact --> in_contact --> always --> clamp --> finishing --> tool --> upkeep
///               (touching)     (free too)           (|F| <= limit)  (touching)
///
/// An effect that the scene does not list is in none of them and has no data: no memory, no call, and no
/// velocity is estimated unless a listed effect needs it.
///
/// A new effect is a file in effects/ with an AddEffect function, its row and parameters in
/// haptic/scene/effects.h, and a line in effect.cpp; the tick does not change.
struct EffectList {
  std::vector<EffectStep> in_contact;            ///< forces while touching
  std::vector<EffectStep> always;                ///< forces in every tick with good input
  std::vector<EffectStep> finishing;             ///< after the clamp; they keep |F| <= limit
  std::array<EffectStep, kTools> tools;          ///< by Tool; those with a step edit the field
  std::vector<EffectStep> upkeep;                ///< after the tool: bounded work on data that edits touch
  std::vector<EffectReset> resets;               ///< called when contact, input or field is lost
  std::optional<VelocityFilter> motion;          ///< there when a listed effect needs it
  std::shared_ptr<const TextureTable> relief;    ///< of the effect texture: felt and heard
  const SoundTick* sound = nullptr;              ///< of the effect sound: what the last tick is heard as
  std::vector<EffectData> data;                  ///< what the steps point to
  std::vector<std::shared_ptr<void>> tool_data;  ///< of tools that are no effect: of every scene

  /// Whether the tool changes the field.
  [[nodiscard]] bool edits(Tool tool) const noexcept {
    return tools[static_cast<std::size_t>(tool)].run != nullptr;
  }
  /// Whether a tick without contact only reports that there is none.
  [[nodiscard]] bool onlyInContact() const noexcept {
    return always.empty() && finishing.empty() && upkeep.empty();
  }
  /// Bytes that the data of an effect takes; 0 when the scene does not list it, or it needs none.
  [[nodiscard]] std::size_t bytesOf(EffectKind kind) const noexcept;
  /// Bytes of all effects together, the list itself left out.
  [[nodiscard]] std::size_t bytes() const noexcept;
};

/// Builds what `scene` lists. `original` is what Scene::max_change is measured against, with the same sign as
/// `now`, the live field: edge snap first pulls to its marks. Deterministic. Allocates and may take long
/// (edge snap reads every tile); not for the haptic thread.
[[nodiscard]] EffectList composeEffects(const Scene& scene, const engine::Version& original,
                                        const engine::Version& now);

/// Makes the data of an effect, which the list then owns; `extra_bytes`: memory it owns apart from the
/// object, for the count.
template <class T>
T& addData(EffectList& list, EffectKind kind, std::shared_ptr<T> data, std::size_t extra_bytes = 0) {
  T& reference = *data;
  list.data.push_back({kind, std::move(data), sizeof(T) + extra_bytes});
  return reference;
}

/// Makes the list estimate the endpoint's velocity.
void needMotion(EffectList& list, const Scene& scene);

/// What effects are made from; see composeEffects.
struct EffectSource {
  const Scene& scene;
  const engine::Version& original;
  const engine::Version& now;
};
/// Adds an effect, or a tool that every scene has, to the list. Allocates.
using AddEffect = void(EffectList& list, const EffectSource& from);

}  // namespace fettle::haptic
