#pragma once

#include <optional>

#include <glm/vec2.hpp>

#include "app/window/window_picture.h"
#include "app/work/loop_client.h"

namespace fettle::app {

/// The left button as the stylus: which tool is on, and what the cursor does to the mouse's stylus. With
/// another device only the choice of the tool is of use. Threading: main.
class Stylus {
 public:
  /// Turns a tool on, or all off: the mouse moves the view then. The tool is there at once, where the cursor
  /// is.
  void choose(std::optional<haptic::Tool> tool, LoopClient& touch, const WindowPicture& picture,
              const glm::dvec2& cursor);
  [[nodiscard]] bool on() const noexcept { return on_; }

  /// `kNone`: a dialog has the hands; `kOther`: they turn the view or set the brush.
  enum class Hands : std::uint8_t { kFree, kOther, kNone };
  /// What cannot wait for the next frame.
  void handle(const render::InputEvent& event, LoopClient& touch, const WindowPicture& picture, Hands hands);
  /// Lifts it off the surface; a tool that Ctrl had turned is what it was. `touch`: null where none is open.
  void release(LoopClient* touch);

  /// It presses.
  [[nodiscard]] bool held() const noexcept { return held_; }
  /// The surface under the cursor, as last looked at with a tool on.
  [[nodiscard]] const std::optional<render::Picked>& underCursor() const noexcept { return under_cursor_; }

 private:
  void press(const render::InputEvent& event, LoopClient& touch);
  void turnBack(LoopClient& touch);
  void lift(haptic::MouseStylus& mouse);

  bool on_ = false;
  bool held_ = false;
  std::optional<render::Picked> under_cursor_;
  std::optional<haptic::Tool> turned_;  // chosen, while Ctrl turned it into its opposite
};

}  // namespace fettle::app
