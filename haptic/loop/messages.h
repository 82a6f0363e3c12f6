#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include <glm/vec3.hpp>

#include "engine/field/live_field.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"
#include "haptic/base/sound_tick.h"
#include "haptic/base/strokes.h"
#include "haptic/devices/device.h"
#include "haptic/devices/workspace.h"
#include "haptic/safety/safety.h"
#include "haptic/scene/scene.h"
#include "haptic/tick/tick.h"

namespace fettle::haptic {

/// A scene prepared for the loop: its composed tick, and the live field that the tick is bound to. Until the
/// loop takes it, the field holds `first` as a placeholder; then the live state moves over, O(1), and the
/// previous scene is sent back to be destroyed.
///
/// Threading: constructed (allocates) and destroyed on the main side, used by the loop in between.
struct PreparedScene {
  /// `scene` in range (sceneProblem). `first`, upright, is what Scene::max_change is measured against; it is
  /// also the placeholder, so no additional memory is held.
  /// `ring`: where the loop sends what a scene with sound is heard as, the same for all scenes of a loop; null: nowhere.
  PreparedScene(const Scene& scene_to_run, const engine::Version& first,
                std::shared_ptr<SoundRing> ring = nullptr)
      : scene(scene_to_run),
        sounds(std::move(ring)),
        original(first),
        field(scene_to_run.invert ? first.inverted() : first, engine::Growth::kNever),
        tick(scene, field, scene_to_run.invert ? first.inverted() : first) {}

  Scene scene;
  std::shared_ptr<SoundRing> sounds;
  engine::Version original;
  engine::LiveField field;
  Tick tick;
};

enum class CommandKind : std::uint8_t {
  kTool,       ///< `tool` from now on; a stroke that runs ends, and goes on as another
  kScene,      ///< `scene` from now on: parameters, effects, inversion
  kWorkspace,  ///< `workspace` from now on: mapping of the device into the field
  kView,       ///< its `scale` and `turn_rad` from now on, without moving the tip
  kSnapshot,   ///< answers kSnapshot: the base of a job that will be adopted
  kAdopt,      ///< continue from `version`, made from the newest kSnapshot; see LoopTick
  /// Continue from exactly `version` (undo, redo); answers kRestored. With `scene` in the same tick with that scene, which
  /// was prepared with another original, and with the workspace moved by `lift_mm`: another form lies over the version.
  kRestore,
  kArm,  ///< made by LoopChannels::armCommand(); disarming is no command: LoopChannels::disarm()
};

/// main -> loop. Every field but those its kind names is ignored.
struct LoopCommand {
  CommandKind kind = CommandKind::kTool;
  Tool tool = Tool::kFeel;
  std::uint64_t id = 0;  ///< returned in the answer; kArm: number of disarms before it
  Workspace workspace;
  double scale = 1.0;     ///< see Workspace::setView
  double turn_rad = 0.0;  ///< see Workspace::setView
  double lift_mm = 0.0;   ///< up, in the field as it is felt
  engine::Version version;
  std::unique_ptr<PreparedScene> scene;  // not null with kScene
};

enum class EventKind : std::uint8_t {
  kEdited,        ///< the field changed within `rect`
  kStrokeEnded,   ///< tool up: `version` is committed; undo goes back to the version before the stroke
  kSnapshot,      ///< answer, with the present `version`
  kAdopted,       ///< answer: `version` is the adopted one with the tiles edited meanwhile carried over
  kAdoptRefused,  ///< answer: nothing changed; take a new snapshot and try again
  kRestored,  ///< answer; `retired` is the previous state, the running stroke included: redo returns to it
  kSceneChanged,  ///< answer
};

/// loop -> main. Events with a version form a chain: `before` is the version of the event before, so only the
/// tiles in which the two differ (engine::changedTiles) changed, and within them only `rect`. The receiver
/// destroys everything that an event holds: so no memory is freed on the loop.
struct LoopEvent {
  EventKind kind = EventKind::kEdited;
  std::uint64_t id = 0;      ///< of the command it answers
  std::uint64_t tick = 0;    ///< ticks whose edits `version` holds
  std::uint64_t stroke = 0;  ///< strokes begun so far
  Tool tool = Tool::kFeel;   ///< that made the last edit, whatever was chosen since
  std::uint32_t merged = 0;  ///< earlier publications that found the ring full and are part of this one
  engine::SampleRect
      rect;  ///< kEdited, kSnapshot: since the event before; kStrokeEnded: of the stroke as well
  engine::Version before;
  engine::Version version;
  engine::Version retired;       ///< the previous state (kAdopted, kRestored) or the version refused
  engine::Version retired_base;  ///< an earlier kSnapshot's
  std::unique_ptr<PreparedScene> retired_scene;
};

/// Input and output of one tick: loop -> main, one per tick, through a separate ring. The inputs in order,
/// written to a strokes file, are the session: a replay of them makes the same field.
struct TickRecord {
  StrokeSample input;         ///< the argument of Tick::run
  glm::dvec3 given_n{0.0};    ///< what the guard let through, device frame
  std::int64_t since_ns = 0;  ///< since the previous tick
  bool contact = false;
};

/// The newest tick, for the display; the main side reads it from a LatestSlot.
struct LoopState {
  std::uint64_t tick = 0;
  std::int64_t time_ns = 0;     ///< engine::steadyNs() at wake-up
  glm::dvec3 endpoint_mm{0.0};  ///< field coordinates
  glm::dvec3 proxy_mm{0.0};     ///< on the surface while in contact, else the endpoint
  glm::dvec3 force_n{0.0};      ///< the scene's, field frame
  glm::dvec3 given_n{0.0};      ///< what the guard let through, device frame
  bool contact = false;
  glm::dvec3 device_mm{0.0};  ///< DeviceInput::position_mm
  /// From the tip along the stylus to the hand, of length 1, in the field; nothing where the device does not measure it.
  std::optional<glm::dvec3> stylus_axis;
  Tool tool = Tool::kFeel;         ///< in effect
  std::uint32_t buttons = 0;       ///< of the device that are held: DeviceInput::buttons
  std::uint64_t tool_choices = 0;  ///< times the next tool was chosen by a button of the device, so far
  std::uint64_t tip_choices = 0;   ///< the next tip, likewise (StylusButtons)
  std::uint64_t menu_choices = 0;  ///< times a menu was asked for, likewise
  LinkState link = LinkState::kDisconnected;
  SafetyState safety = SafetyState::kDisconnected;
  FaultCause cause = FaultCause::kNone;
  std::uint64_t stroke = 0;
  std::uint64_t merged = 0;          ///< publications that found the ring full, so far
  std::uint64_t refused_edits = 0;   ///< writes that found the tile pool empty, so far
  std::uint64_t adopted = 0;         ///< versions adopted so far
  std::uint64_t carried = 0;         ///< tiles carried over adoptions so far
  std::uint64_t lost_records = 0;    ///< ticks whose record found its ring full, so far
  std::uint64_t not_prefetched = 0;  ///< ticks without surface: samples still on the disk
  TickCounters counters;
  SafetyCounters safety_counters;
};

}  // namespace fettle::haptic
