#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "engine/base/error.h"
#include "engine/filter/filter.h"
#include "engine/history/history.h"
#include "engine/session/session.h"
#include "haptic/scene/scene.h"

namespace fettle::haptic {

// What happened in the window, as a session's journal keeps it: enough to make every state of the session
// again, bit for bit, from the scan. docs/formats.md describes the JSON; session_player.h plays it.

/// Where in a loop's life something was: after `tick` ticks, or right after the command that the loop
/// answered then, before it went on to the next tick.
struct LoopPlace {
  std::uint64_t tick = 0;
  bool answered = false;
  friend bool operator==(const LoopPlace&, const LoopPlace&) = default;
};

namespace journal {

/// A loop starts on a state; ticks are counted from 0 again.
struct Begin {
  std::int64_t state = 0;
  haptic::Scene scene;
};
/// The next ticks' inputs; the entry's data is a block of TickPacker.
struct Ticks {
  std::int64_t count = 0;
};
/// Ticks that were not recorded: nothing after them can be played.
struct Lost {
  std::int64_t count = 0;
};
struct SceneSet {
  LoopPlace at;
  haptic::Scene scene;
};
/// A step led to state `state`: what the field was there. With `marks` it is the state before with the marks
/// that the entry's data tells (mark_codec.h): set by other means than strokes.
struct StepMade {
  std::int64_t state = 0;
  std::string name;
  engine::StepKind kind = engine::StepKind::kStroke;
  LoopPlace at;
  bool marks = false;
};
/// State `state` as it is now was asked for ...
struct RestoreAsked {
  std::uint64_t id = 0;
  std::int64_t state = 0;
};
/// ... and is felt from here on.
struct Restored {
  std::uint64_t id = 0;
  LoopPlace at;
};
/// The field there is what a filter was computed on ...
struct FilterBase {
  std::uint64_t id = 0;
  LoopPlace at;
};
/// ... whose result is now brought into the live field (haptic::adoptFiltered) ...
struct FilterBegun {
  std::uint64_t id = 0;  ///< of its base
  engine::FilterSpec spec;
};
/// ... which asked for the field there ...
struct Snapshot {
  LoopPlace at;
};
/// ... and offered a version there.
struct Offered {
  LoopPlace at;
  bool taken = false;
};

using Entry = std::variant<Begin, Ticks, Lost, SceneSet, StepMade, RestoreAsked, Restored, FilterBase,
                           FilterBegun, Snapshot, Offered>;

}  // namespace journal

/// One JSON object without line breaks; numbers read back to the same bits.
[[nodiscard]] std::string journalText(const journal::Entry& entry);
/// Errors (kInput): no such object, a missing or wrong field, an unknown action.
[[nodiscard]] engine::Result<journal::Entry> journalEntry(const std::string& text);

}  // namespace fettle::haptic
