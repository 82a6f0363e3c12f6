#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/work/background.h"
#include "app/work/loop_client.h"

namespace fettle::app {

/// Changes of many marks at once (lasso, box, all, none) and of edge lines, computed in the background in the order of
/// the requests. Each becomes one step; a stroke that runs meanwhile continues and is kept; a change of lines waits for
/// its end.
/// Threading: main.
class MarkEdit {
 public:
  /// Makes the new marks and edge lines of a version: the same heights.
  using Change = std::function<engine::Result<engine::Version>(const engine::Version&, engine::JobControl&)>;

  /// `unchanged`: the notice for a change that turns out to change nothing; none if empty. `edges`: the suggestion that
  /// the change takes whole.
  void ask(std::string name, Change change, Notice unchanged = {}, std::optional<TakenEdges> edges = {});
  /// Cancels waiting and running changes.
  void cancel();
  /// Cancels the one asked for last; its name, or nothing when none waits or runs.
  std::optional<std::string> cancelNewest();
  /// Starts waiting changes, applies finished ones. True when something visible changed.
  [[nodiscard]] bool poll(LoopClient& client, std::vector<Notice>& notices);

  [[nodiscard]] bool busy() const noexcept { return working_.busy() || done_ || !waiting_.empty(); }
  /// The name of the change that is worked out.
  [[nodiscard]] const std::string& what() const noexcept { return running_.name; }
  [[nodiscard]] WorkProgress progress() const { return working_.progress(); }

 private:
  struct Request {
    std::string name;
    Change change;
    Notice unchanged;
    std::optional<TakenEdges> edges;
  };
  struct Done {
    engine::Version base, changed;
  };
  std::deque<Request> waiting_;
  Request running_;
  Background<Done> working_;
  std::optional<Done> done_;  // waits for the end of a stroke
};

}  // namespace fettle::app
