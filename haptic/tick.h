#pragma once

#include "engine/field/live_field.h"
#include "engine/field/version.h"
#include "haptic/contact.h"
#include "haptic/effect.h"
#include "haptic/scene.h"
#include "haptic/strokes.h"
#include "haptic/surface.h"
#include "haptic/tick_counters.h"

namespace fettle::haptic {

/// One haptic update, the same for replay and the live loop:
///
///   endpoint --> contact --> force effects --> clamp --> tool (smooth, mark, unmark) --> force sample
///                reads the field                         edits the field, felt from the next tick on
///
/// Threading: prepared anywhere (the constructor allocates), then run() on the one thread that owns the
/// field: noexcept, allocates, locks and logs nothing with Growth::kNever, and its loops are bounded
/// (kMaxCellsVisited, RayWalk::kMaxSteps, the brush). The field must outlive the tick.
class Tick {
 public:
  /// `scene` is in range (sceneProblem). `original`: see composeEffects. The live field is already the way up
  /// that is to be felt.
  Tick(const Scene& scene, engine::LiveField& field, const engine::Version& original);

  /// One tick. An input that is not finite is no input: zero force, contact ends, counted.
  ForceSample run(const StrokeSample& input) noexcept;

  /// The contact of the last tick.
  [[nodiscard]] const Contact& contact() const noexcept { return contact_; }
  [[nodiscard]] const TickCounters& counters() const noexcept { return counters_; }
  /// The surface as the last tick left it.
  [[nodiscard]] Surface& surface() noexcept { return surface_; }

  /// To be called after the field changed from outside (adopt, undo): the next tick feels it.
  void fieldChanged() noexcept { surface_.refresh(field_.reader()); }

 private:
  engine::LiveField& field_;
  Surface surface_;
  ContactTracker tracker_;
  EffectList effects_;
  double force_limit_n_;
  Contact contact_;
  TickCounters counters_;
};

}  // namespace fettle::haptic
