#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "app/work/stroke_path.h"
#include "engine/history/history.h"
#include "haptic/base/strokes.h"
#include "haptic/journal/journal.h"
#include "haptic/journal/recorder.h"
#include "haptic/journal/session_sink.h"
#include "haptic/loop/haptic_loop.h"

namespace fettle::app {

/// What a live loop writes to a session for replay: the input of each tick, each scene, step and round of a
/// filter's adoption, with the tick that took it, in that order (journal.h). Without a sink no function has
/// an effect. Threading: main.
class LoopJournal {
 public:
  /// `sink` outlives this; null: nothing is recorded.
  explicit LoopJournal(haptic::SessionSink* sink) : sink_(sink) {}

  [[nodiscard]] bool records() const noexcept { return sink_ != nullptr; }

  /// A loop starts from a state of the history. Entries of the loop before were flushed. `continues`: after another one.
  void begin(std::int64_t state, const haptic::Scene& scene, bool continues);
  /// A state under a form was read from the file.
  void stateRead(std::int64_t state);
  /// Takes the ticks that the loop has recorded, and adds them to the path of the stroke. True when ticks were lost
  /// since the last call.
  [[nodiscard]] bool takeTicks(haptic::HapticLoop& loop, StrokePath& path);
  /// Whether all ticks that precede this event in the journal were taken.
  [[nodiscard]] bool reached(const haptic::LoopEvent& event) const noexcept;

  /// A scene was sent to the loop under this id; it is recorded when the loop answers.
  void sceneSent(std::uint64_t id, const haptic::Scene& scene);
  /// An answer of the loop, in the order of its answers.
  void answered(const haptic::LoopEvent& event);
  /// A filter begins to be computed on the field at `place`: its number from then on.
  [[nodiscard]] std::uint64_t filterBase(const haptic::LoopPlace& place);
  void filterBegun(std::uint64_t base, const engine::FilterSpec& spec);
  void offerMade() { recorder_.offerMade(); }

  /// A step was made: it is written to the session with all recorded so far.
  void commit(const haptic::journal::StepMade& made, const engine::Step& step, std::string data);
  /// The history is in this state. What was recorded so far waits for the next entry of the session.
  void moveTo(std::int64_t state);
  /// The loop was requested, with this id, to restore the history's state.
  void restoreRequested(std::uint64_t id, std::int64_t state);
  /// Writes the recorded entries: when they are many, or all.
  void flushWhenDue();
  void flush();

 private:
  haptic::SessionSink* sink_;
  haptic::Recorder recorder_;
  std::uint64_t recorded_ = 0;  // ticks, those lost included
  std::uint64_t lost_ = 0;
  std::deque<std::pair<std::uint64_t, haptic::Scene>> scenes_;  // sent, not answered
  std::uint64_t filters_ = 0;
};

/// Whether an event answers a command.
[[nodiscard]] constexpr bool isAnswer(haptic::EventKind kind) noexcept {
  return kind != haptic::EventKind::kEdited && kind != haptic::EventKind::kStrokeEnded;
}

/// Makes steps of a live field's versions: a stroke, the adoption of a filter and a change of all marks are
/// one step each. Every step is written to the session with the journal that replays it. All versions here
/// are upright. Threading: main.
class StepKeeper {
 public:
  StepKeeper(engine::History history, haptic::SessionSink* sink)
      : history_(std::move(history)), committed_(history_.current()), journal_(sink) {}

  [[nodiscard]] const engine::History& history() const noexcept { return history_; }
  [[nodiscard]] LoopJournal& journal() noexcept { return journal_; }
  /// Where the last step changed something.
  [[nodiscard]] engine::SampleRect lastRect() const noexcept { return last_rect_; }
  /// Whether the loop's field differs from the last step's: a stroke runs.
  [[nodiscard]] bool differs(const engine::Version& field) const { return !(field == committed_); }
  /// Puts a step read back from a session in front of those held.
  void prepend(engine::Step step);

  /// A loop starts from the history's state.
  void begin(const haptic::Scene& scene);

  /// Sets the tool of the running stroke.
  void strokeIsOf(haptic::Tool tool) noexcept { stroke_tool_ = tool; }
  /// Makes a step of a running stroke; none when the field has not changed.
  void keepStroke(const engine::Version& field, const haptic::LoopPlace& at);
  /// A stroke ended that changed samples within `rect` only.
  void endStroke(const engine::Version& field, const engine::SampleRect& rect, const haptic::LoopPlace& at);

  /// A filter's adoption begins under a name for the list of steps: its rounds are one step.
  void nameAdoption(std::string name) { adoption_name_ = std::move(name); }
  void adopted(const engine::Version& field, const haptic::LoopPlace& at);
  /// Later adoptions are another step.
  void endAdoption() noexcept { adopting_ = false; }
  [[nodiscard]] bool adopting() const noexcept { return adopting_; }

  /// A change of marks, lines, the form or all heights that no tick made.
  struct HandChange {
    std::string data;  ///< as of haptic::packMarkChanges, haptic::packLineChange or engine::packForm
    std::optional<haptic::journal::EdgesSuggested> suggested;
    bool heights = false;                                    ///< of kForm: what was seen are the samples
    std::optional<haptic::journal::FormFitted> fitted = {};  ///< of kForm
    std::optional<haptic::HeightsMaker> maker = {};  ///< of kFilter: the heights, made of those before
  };
  /// Changes the marks (kMark), the edge lines and marks (kLines) or the form (kForm), or by a maker the heights (kFilter), of the newest step's field.
  void change(std::string name, engine::StepKind kind, const engine::Version& field,
              const haptic::LoopPlace& at, HandChange change);

  /// How many undone steps later ones took the place of, since the last call.
  [[nodiscard]] std::int64_t takeReplaced() noexcept { return std::exchange(replaced_, 0); }

  /// Move in the history; return the version to be restored, if there is such a state.
  std::optional<engine::Version> undo() { return history_.undo(); }
  std::optional<engine::Version> redo() { return history_.redo(); }
  std::optional<engine::Version> goTo(std::int64_t state) { return history_.goTo(state); }
  /// The loop was requested, with `id`, to restore the history's state, and has done so.
  void restoreRequested(std::uint64_t id);
  void restored(const engine::Version& field) { committed_ = field; }

 private:
  // Without a change the step was made by ticks and filters. False: it changed nothing, and is none.
  bool push(std::string name, engine::StepKind kind, const engine::Version& after,
            const haptic::LoopPlace& at, std::optional<HandChange> change = {});

  engine::History history_;
  engine::Version committed_;  // the last step's, the reference for a running stroke
  LoopJournal journal_;
  engine::SampleRect last_rect_;
  std::int64_t replaced_ = 0;
  haptic::Tool stroke_tool_ = haptic::Tool::kFeel;
  std::string adoption_name_ = "Filter";
  bool adopting_ = false;  // the running adoption has a step
  bool begun_ = false;     // a loop before the present one
};

}  // namespace fettle::app
