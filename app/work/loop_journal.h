#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <utility>

#include "app/work/stroke_path.h"
#include "engine/history/history.h"
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

  /// A loop starts from a state of the history. Entries of the loop before were flushed.
  void begin(std::int64_t state, const haptic::Scene& scene);
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

}  // namespace fettle::app
