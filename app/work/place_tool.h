#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "app/work/background.h"
#include "app/work/loop_client.h"
#include "engine/field/version.h"
#include "engine/suggest/worth_places.h"

namespace fettle::app {

/// The places where a line by hand is worth most, searched for in the background and gone through one after the other.
/// A place is done when an edge line runs along it, whoever drew it; undoing the line opens it again.
/// Threading: main.
class PlaceTool {
 public:
  enum class State : std::uint8_t { kOpen, kDone, kSkipped };

  /// Searches on the present field, and drops what there is.
  void search(const LoopClient& client);
  void drop();
  /// To the next open place, the first one after the last; the present one counts as skipped if it is not done.
  /// False when no other is open: then none is present.
  bool next();
  /// Takes a result, and looks at the lines of the newest field. True when something visible changed.
  [[nodiscard]] bool poll(const LoopClient& client, std::vector<Notice>& notices);
  /// The present place, once after it was come to: the view is to go there.
  [[nodiscard]] std::optional<std::size_t> takeArrival() noexcept;

  /// Searching or showing.
  [[nodiscard]] bool on() const noexcept { return busy() || found_.has_value(); }
  [[nodiscard]] bool busy() const noexcept { return searching_.busy() && !searching_.cancelling(); }
  [[nodiscard]] WorkProgress progress() const { return searching_.progress(); }
  /// Null when none were searched for.
  [[nodiscard]] const engine::WorthPlaces* found() const noexcept { return found_ ? &*found_ : nullptr; }
  [[nodiscard]] State state(std::size_t place) const noexcept { return states_[place]; }
  [[nodiscard]] std::optional<std::size_t> present() const noexcept { return present_; }
  [[nodiscard]] std::size_t count(State state) const noexcept;
  /// Whether heights have changed since the search, so that places and estimates are of another surface. Undoing that
  /// makes them valid again; lines and marks change no height.
  [[nodiscard]] bool outdated() const noexcept { return outdated_; }
  /// Differs whenever something is to be drawn otherwise.
  [[nodiscard]] std::uint64_t revision() const noexcept { return revision_; }

 private:
  void lookAtLines(const engine::EdgeLines& lines);

  Background<engine::WorthPlaces> searching_;
  std::optional<engine::WorthPlaces> found_;
  std::vector<State> states_;
  std::optional<std::size_t> present_;
  bool arrived_ = false;
  engine::EdgeLines seen_;               // that states_ is of
  engine::Version searched_, compared_;  // compared_: with searched_, for outdated_
  bool outdated_ = false;
  std::uint64_t revision_ = 0;
};

}  // namespace fettle::app
