#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "app/window/actions.h"
#include "app/window/parts.h"

namespace fettle::app {

/// The input since the last frame, in order, and its receiver: a dialog, the brush being set, the lasso, an
/// action's key, the camera. The stylus gets its events before the frame processes the others, unless a key
/// that may choose another tool is waiting: then the stylus waits behind it. Threading: main.
class Input {
 public:
  /// Events taken from the queue so far, and files dropped on the window.
  struct Counts {
    std::uint64_t keys = 0, buttons = 0, wheels = 0, drops = 0;
  };
  /// The effect of a key on the whole window.
  struct Request {
    std::optional<Action> action;
    std::optional<std::string> open;  ///< a recent file
  };

  /// Called immediately, also while the device draws.
  void add(const render::InputEvent& happened, Parts& parts);
  /// Smoothing lowers the surface under a cursor at rest: the stylus follows it.
  void followSurface(Parts& parts) const;
  /// The next event that can be handled: none while the answer to a dialog waits for the frame that executes
  /// it, since later events refer to its result.
  [[nodiscard]] std::optional<render::InputEvent> next(Parts& parts);
  /// Passes it to its receiver. Parts::cursor is the previous position.
  [[nodiscard]] static Request handle(const render::InputEvent& event, Parts& parts);

  void countDrop() noexcept { ++counts_.drops; }
  [[nodiscard]] bool empty() const noexcept { return queue_.empty(); }
  /// A frame begins.
  void beginFrame() noexcept { acted_ = false; }
  /// Whether the frame had an event that may open a list, scroll or fold a panel: those stand in their place one frame later,
  /// which must not wait.
  [[nodiscard]] bool acted() const noexcept { return acted_; }
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }

 private:
  struct Pending {
    render::InputEvent event;
    bool stylus_has_it = false;
  };
  void disarmAtOnce(const render::InputEvent& event, Parts& parts);

  std::deque<Pending> queue_;
  Counts counts_;
  bool acted_ = false;
};

}  // namespace fettle::app
