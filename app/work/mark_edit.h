#pragma once

#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "app/work/background.h"
#include "app/work/touch.h"

namespace fettle::app {

/// Changes of many marks at once (lasso, box, all, none), worked out in the background in the order in which
/// they were asked for. Each becomes one step; a stroke that runs meanwhile goes on and is kept.
/// Threading: main.
class MarkEdit {
 public:
  /// Makes the new marks of a version: the same heights.
  using Change = std::function<engine::Result<engine::Version>(const engine::Version&, engine::JobControl&)>;

  void ask(std::string name, Change change);
  /// Forgets what waits and what is under way.
  void cancel();
  /// Starts what waits, puts in place what is done. True when something to be seen changed.
  [[nodiscard]] bool poll(Touch& touch, std::vector<Notice>& notices);

  [[nodiscard]] bool busy() const noexcept { return working_.busy() || !waiting_.empty(); }
  [[nodiscard]] double progress() const noexcept { return working_.progress(); }

 private:
  struct Asked {
    std::string name;
    Change change;
  };
  struct Done {
    engine::Version base, marked;
  };
  std::deque<Asked> waiting_;
  std::string name_;
  Background<Done> working_;
};

}  // namespace fettle::app
