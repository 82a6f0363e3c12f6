#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/field/sample_rect.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// How far apart two versions are.
struct Change {
  std::int64_t tiles = 0;  ///< places of the table whose tile is another object
  std::int64_t nodes = 0;  ///< inner nodes that are other objects
  /// Around those tiles, clipped to the field: whole tiles, unchanged samples included; and around the edge lines that
  /// only one of them has.
  SampleRect rect;
  bool inverted = false;       ///< whether the signs differ
  std::size_t line_bytes = 0;  ///< of the lines of the later version, where they are other ones
  bool lines = false;          ///< whether the edge lines are other ones
  bool form = false;           ///< whether another form lies over the field, or none

  [[nodiscard]] bool none() const noexcept { return tiles == 0 && !inverted && !lines && !form; }
  /// Memory of one version that the other does not share [bytes].
  [[nodiscard]] std::size_t bytes() const noexcept {
    return static_cast<std::size_t>(tiles) * sizeof(Tile) + static_cast<std::size_t>(nodes) * sizeof(Node) +
           line_bytes;
  }
};

/// Compares pointers, not samples: O(changed tiles), nothing is allocated. Both versions have one size and
/// one memory. Any thread.
[[nodiscard]] Change measureChange(const Version& before, const Version& after) noexcept;

/// What made a step.
enum class StepKind : std::uint8_t { kStroke, kFilter, kMark, kInvert, kImport, kLines, kForm };

/// "stroke", "filter", "mark", "invert", "import", "lines", "form"; these words are stored in session files.
[[nodiscard]] std::string_view stepKindName(StepKind kind) noexcept;
[[nodiscard]] std::optional<StepKind> stepKindFromName(std::string_view name) noexcept;

/// UTC, to the millisecond.
using StepTime = std::chrono::sys_time<std::chrono::milliseconds>;
[[nodiscard]] StepTime stepTimeNow() noexcept;

/// Description of a step for a list of steps.
struct StepInfo {
  std::string name;  ///< for a person, e.g. "Median 5 x 5"
  StepKind kind = StepKind::kStroke;
  StepTime time{};
  /// Where samples or marks changed; whole tiles unless the caller of push() gave a smaller rectangle.
  SampleRect rect;
  std::size_t bytes = 0;  ///< memory needed only for undoing this step [bytes]
};

/// One edit: the state it was made on and the state it made.
struct Step {
  StepInfo info;
  Version before;
  Version after;
};

/// Linear undo and redo: a sequence of states, each but the first made from the one before it by a step.
///
///   state   0 ------- 1 ------- 2 ------- 3 ------- 4          numbered from the original scan on
///              step 1    step 2    step 3    step 4
///           ^ first()           ^ number()          ^ last()
///
/// Step k leads from state k - 1 to state k. Undo and redo move number(); a push discards the steps after it.
/// Versions share tiles, so the memory of a state is what its step changed. Once the states together cost
/// more than the bound the oldest are dropped: first() rises, numbers stay. (A session file keeps them, see
/// session.h.)
///
/// Threading: one thread (the main side). Dropping versions frees the tiles that only they hold: 50 ns per
/// tile; the calls that drop versions return them, so that the caller may free them on another thread.
class History {
 public:
  static constexpr std::size_t kNoBound = std::numeric_limits<std::size_t>::max();

  /// Empty; may only be assigned to.
  History() = default;

  /// Starts at state `number`, the present state of the field.
  explicit History(Version start, std::size_t bound_bytes = kNoBound, std::int64_t number = 0);

  /// Restores a sequence of steps, as read from a session file: steps[0] leads from state `first` to first +
  /// 1 and its `before` is that state, each next one's `before` is `after` of the one before it; `number`
  /// lies in first .. first + steps.size(). `state` is the version of `number`. Nothing is dropped, even
  /// above the bound.
  History(Version state, std::int64_t number, std::int64_t first, std::vector<Step> steps,
          std::size_t bound_bytes);

  /// Adds the step from current() to `after` and goes there. No step is made, and false returned, when
  /// `after` is the same state, which it then stands for. An empty `rect` is replaced by that of the changed tiles; info.bytes is
  /// filled in. `dropped` receives the versions that the history drops: redo states, and the oldest beyond
  /// the bound. The newest step is always kept. O(changed tiles), a few ns each.
  bool push(StepInfo info, Version after, std::vector<Version>& dropped);
  /// As above, freeing what is dropped immediately.
  bool push(StepInfo info, Version after);

  [[nodiscard]] const Version& current() const noexcept { return state(number_); }
  [[nodiscard]] std::int64_t number() const noexcept { return number_; }
  [[nodiscard]] std::int64_t first() const noexcept { return first_; }
  [[nodiscard]] std::int64_t last() const noexcept {
    return first_ + static_cast<std::int64_t>(steps_.size());
  }
  [[nodiscard]] bool canUndo() const noexcept { return number_ > first_; }
  [[nodiscard]] bool canRedo() const noexcept { return number_ < last(); }

  /// Goes one step back or forward and returns the version to restore; empty at the end of the sequence.
  /// O(1).
  [[nodiscard]] std::optional<Version> undo() noexcept;
  [[nodiscard]] std::optional<Version> redo() noexcept;
  /// Goes to any state that is held; empty, and no move, for others. O(1).
  [[nodiscard]] std::optional<Version> goTo(std::int64_t number) noexcept;

  /// State `number`, in first() .. last().
  [[nodiscard]] const Version& state(std::int64_t number) const noexcept;
  /// Step `number`, in first() + 1 .. last(): it led to the state of that number.
  [[nodiscard]] const StepInfo& info(std::int64_t number) const noexcept;
  [[nodiscard]] Step step(std::int64_t number) const;

  /// Puts an older step in front of the first (read back from a session file); its `after` is state(first()).
  void prepend(Step step);

  /// Memory of all states beyond that of one [bytes]. Updated step by step; exact unless a step restored
  /// tiles of an older state (a tile is then counted each time it is removed or added).
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }
  [[nodiscard]] std::size_t bound() const noexcept { return bound_; }
  void setBound(std::size_t bound_bytes, std::vector<Version>& dropped);

 private:
  struct Made {
    StepInfo info;
    Version after;
  };
  void keepBound(std::vector<Version>& dropped);

  Version start_;  // state first_
  std::deque<Made> steps_;
  std::int64_t first_ = 0;
  std::int64_t number_ = 0;
  std::size_t bytes_ = 0;
  std::size_t bound_ = kNoBound;
};

}  // namespace fettle::engine
