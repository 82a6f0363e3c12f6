#pragma once

#include <optional>

#include <glm/vec2.hpp>

#include "app/window/window_picture.h"
#include "app/work/loop_client.h"

namespace fettle::app {

/// The left button as the stylus: the active tool, and the effect of the cursor on the mouse's stylus. With
/// another device only the choice of the tool is used. Threading: main.
class Stylus {
 public:
  /// Switches a tool on, or all off: then the mouse moves the view. The tool is applied immediately at the
  /// cursor.
  void choose(std::optional<haptic::Tool> tool, LoopClient& client, const WindowPicture& picture,
              const glm::dvec2& cursor);
  [[nodiscard]] bool on() const noexcept { return on_; }

  /// `kNone`: a dialog has the input; `kOther`: it turns the view or sets the brush.
  enum class Hands : std::uint8_t { kFree, kOther, kNone };
  /// Handles input that cannot wait for the next frame; `pen`: as it is held, if the event is of one.
  void handle(const render::InputEvent& event, LoopClient& client, const WindowPicture& picture, Hands hands,
              const std::optional<haptic::PenHold>& pen);
  /// With another device than the mouse: a stroke that begins while Shift is held smooths, whatever the tool. `touches`:
  /// the stylus is in contact.
  void follow(bool shift, bool touches, LoopClient& client);
  /// Lifts the stylus off the surface and undoes a change of tool by Ctrl or Shift. `client`: null where none is open.
  void release(LoopClient* client);

  /// Whether it presses.
  [[nodiscard]] bool held() const noexcept { return held_; }
  /// The surface under the cursor, as of the last pick with a tool on.
  [[nodiscard]] const std::optional<render::Picked>& underCursor() const noexcept { return under_cursor_; }

 private:
  void press(const render::InputEvent& event, LoopClient& client);
  void turnBack(LoopClient& client);
  void lift(haptic::MouseStylus& mouse);

  bool on_ = false;
  bool held_ = false;
  std::optional<render::Picked> under_cursor_;
  std::optional<haptic::Tool>
      turned_;  // the chosen tool, while Ctrl replaces it by its opposite, or Shift by smoothing
};

}  // namespace fettle::app
