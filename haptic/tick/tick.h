#pragma once

#include <cstddef>
#include <memory>

#include "engine/field/live_field.h"
#include "engine/field/version.h"
#include "haptic/base/strokes.h"
#include "haptic/base/tick_counters.h"
#include "haptic/contact/contact.h"
#include "haptic/contact/sphere_tip.h"
#include "haptic/contact/surface.h"
#include "haptic/effects/effect.h"
#include "haptic/scene/scene.h"

namespace fettle::haptic {

/// One haptic update, the same for replay and the live loop:
///
///   endpoint --> contact --> forces --> clamp --> finishing --> tool (haptic/base/tools.h) --> sample
///
/// The contact reads the field, the tool edits it, and the edit is felt from the next tick on.
///
/// Time. Effects that depend on time take it from StrokeSample::t: in a replay as recorded, in the live loop
/// the time of the tick. A time that does not advance, goes back, is not finite or has a gap above 20 ms
/// gives no speed, and there is no damping in that tick (VelocityFilter).
///
/// Threading: prepared anywhere (the constructor allocates), then run() on the one thread that owns the
/// field: noexcept, allocates, locks and logs nothing with Growth::kNever, and its loops are bounded
/// (kMaxCellsVisited, RayWalk::kMaxSteps, the brush). The field must outlive the tick.
class Tick {
 public:
  /// `scene` is in range (sceneProblem). `original`: see composeEffects. The live field already has the sign
  /// that is to be felt.
  Tick(const Scene& scene, engine::LiveField& field, const engine::Version& original);

  /// One tick. An input that is not finite counts as none: zero force, contact ends, effects are reset,
  /// counted. Without contact only effects that act in free space give force.
  ForceSample run(const StrokeSample& input) noexcept;

  /// The contact of the last tick.
  [[nodiscard]] const Contact& contact() const noexcept { return contact_; }
  [[nodiscard]] const TickCounters& counters() const noexcept { return counters_; }
  /// Bytes held for the shape of the tip: 0 for a point.
  [[nodiscard]] std::size_t tipBytes() const noexcept { return sphere_ ? sizeof(SphereTracker) : 0; }
  /// The surface as the last tick left it.
  [[nodiscard]] Surface& surface() noexcept { return surface_; }

  /// The composed effects of the scene and their data.
  [[nodiscard]] const EffectList& effects() const noexcept { return effects_; }
  /// What the last tick is heard as, `seconds` left out; null when the scene lists no sound.
  [[nodiscard]] const SoundTick* heard() const noexcept { return effects_.sound; }
  /// Force of the last tick that only holds up the stylus [N]: also with the hand at rest in free space.
  [[nodiscard]] const glm::dvec3& weight() const noexcept { return weight_n_; }

  /// To be called after the field was replaced (adopt, undo): the next tick feels it, and the effects' state
  /// about the old surface is reset.
  void fieldChanged() noexcept;

 private:
  void reset(ResetCause why) noexcept;

  engine::LiveField& field_;
  Surface surface_;
  ContactTracker tracker_;
  std::unique_ptr<SphereTracker> sphere_;  // null with a point for a tip
  EffectList effects_;
  double force_limit_n_;
  glm::dvec3 weight_n_{0.0};
  Contact contact_;
  TickCounters counters_;
};

}  // namespace fettle::haptic
