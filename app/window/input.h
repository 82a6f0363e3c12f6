#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "app/window/actions.h"
#include "app/window/parts.h"

namespace fettle::app {

/// What hands did since the last frame, in order, and who has it: a dialog, the brush that is being set, the
/// lasso, an action's key, the camera. The stylus has its events before the frame comes to the others, unless
/// a key waits that may choose another tool: then it waits behind it. Threading: main.
class Input {
 public:
  /// Events taken from the queue so far, and files dropped on the window.
  struct Counts {
    std::uint64_t keys = 0, buttons = 0, wheels = 0, drops = 0;
  };
  /// What a key asks for.
  struct Request {
    std::optional<Action> action;
    std::optional<std::string> open;  ///< a recent file
  };

  /// As it comes, also while the device draws.
  void add(const render::InputEvent& event, Parts& parts);
  /// What is under a cursor at rest sinks while it is smoothed: the stylus goes with it.
  void followSurface(Parts& parts) const;
  /// The next event that can be handled: none while an answer to a dialog waits for the frame that carries it
  /// out, since what comes after it is about what that leads to.
  [[nodiscard]] std::optional<render::InputEvent> next(Parts& parts);
  /// Hands it to whom it is for. Parts::cursor is where it was before.
  [[nodiscard]] static Request handle(const render::InputEvent& event, Parts& parts);

  void countDrop() noexcept { ++counts_.drops; }
  [[nodiscard]] bool empty() const noexcept { return queue_.empty(); }
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }

 private:
  struct Pending {
    render::InputEvent event;
    bool stylus_has_it = false;
  };
  void disarmAtOnce(const render::InputEvent& event, Parts& parts);

  std::deque<Pending> queue_;
  Counts counts_;
};

}  // namespace fettle::app
