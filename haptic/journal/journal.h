#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "engine/base/error.h"
#include "engine/filter/filter.h"
#include "engine/history/history.h"
#include "engine/measure/three_points.h"
#include "engine/session/session.h"
#include "haptic/journal/computed_heights.h"
#include "haptic/scene/scene.h"

namespace fettle::haptic {

// Events of the window, as stored in a session's journal: sufficient to reproduce every state of the session,
// bit-identical, from the scan. docs/formats.md describes the JSON; session_player.h plays it.

/// A point in a loop's sequence: after `tick` ticks, or immediately after the command that the loop answered
/// then, before the next tick.
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
  /// The program had the states in memory, as at another rate. Else they are those of the file: under a form they are seen
  /// afresh from what is stored.
  bool continues = false;
};
/// A state under a form was read from the file, since memory no longer held it: it is seen afresh from what is stored.
struct StateRead {
  std::int64_t state = 0;
};
/// The next ticks' inputs; the entry's data is a block of TickPacker.
struct Ticks {
  std::int64_t count = 0;
};
/// Ticks that were not recorded: nothing after them can be replayed.
struct Lost {
  std::int64_t count = 0;
};
struct SceneSet {
  LoopPlace at;
  haptic::Scene scene;
};
/// The numbers of a suggestion of edges (fettle::engine::findEdges, EdgeChoice), as a step took it whole.
struct EdgesSuggested {
  double scale = 0.0;  ///< of the search [samples]
  double sensitivity = 0.0;
  double thickness = 0.0;  ///< [samples]
};
/// How a form was found that a step laid over the field (engine::FormChoice, as words), to be found so on another scan.
struct FormFitted {
  std::string form;
  std::string region;
  bool robust = false;
  std::optional<engine::ThreePoints> through = {};
};
/// A step led to state `state`: the field at that point. With `marks` it is the state before with the marks
/// of the entry's data (mark_codec.h), set by other means than strokes; with `lines`, with its marks and edge
/// lines (mark_codec.h); with `form` under the form of the entry's data (engine::packForm), with `heights` what was seen
/// of it as samples, under none. With `suggested` these were the suggested edges of the heights before the step: a replay
/// takes them from the data, a recipe suggests them again on another scan. So it is with `fitted` of a form.
struct StepMade {
  std::int64_t state = 0;
  std::string name;
  engine::StepKind kind = engine::StepKind::kStroke;
  LoopPlace at;
  bool marks = false;
  bool lines = false;
  std::optional<EdgesSuggested> suggested = {};
  bool form = false;
  bool heights = false;
  std::optional<FormFitted> fitted = {};
  /// The heights are those of the state before as this makes them: kind kFilter. An action of its own in the text, "computed", which programs
  /// without it refuse to replay.
  std::optional<HeightsMaker> maker = {};
};
/// The restoring of state `state` was requested ...
struct RestoreRequested {
  std::uint64_t id = 0;
  std::int64_t state = 0;
};
/// ... and was restored here.
struct Restored {
  std::uint64_t id = 0;
  LoopPlace at;
};
/// The field at that point is the input of a filter ...
struct FilterBase {
  std::uint64_t id = 0;
  LoopPlace at;
};
/// ... whose result is now adopted into the live field (haptic::adoptFiltered) ...
struct FilterBegun {
  std::uint64_t id = 0;  ///< of its base
  engine::FilterSpec spec;
};
/// ... for which a snapshot was taken there ...
struct Snapshot {
  LoopPlace at;
};
/// ... and offered a version there.
struct Offered {
  LoopPlace at;
  bool taken = false;
};

using Entry = std::variant<Begin, StateRead, Ticks, Lost, SceneSet, StepMade, RestoreRequested, Restored,
                           FilterBase, FilterBegun, Snapshot, Offered>;

}  // namespace journal

/// One JSON object without line breaks; numbers read back to the same bits.
[[nodiscard]] std::string journalText(const journal::Entry& entry);
/// Errors (kInput): no such object, a missing or wrong field, an unknown action.
[[nodiscard]] engine::Result<journal::Entry> journalEntry(const std::string& text);

}  // namespace fettle::haptic
