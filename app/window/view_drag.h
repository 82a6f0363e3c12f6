#pragma once

#include "app/window/window_picture.h"

namespace fettle::app {

/// The mouse at the camera: buttons turn, move and zoom the view, the wheel zooms, and a handle moves the
/// line between two versions. Threading: main.
class ViewDrag {
 public:
  /// The environment of the drag.
  struct Scope {
    const engine::Grid& grid;  ///< of the shown field
    const render::Rectangle& area;
    WindowPicture& picture;
    render::View& view;
    Settings& settings;
  };
  /// `from`: the cursor before the event; `tool_on`: the left button is the stylus.
  void handle(const render::InputEvent& event, const glm::dvec2& from, bool tool_on, const Scope& scope);
  void stop() noexcept;
  /// Whether a button turns, moves or zooms.
  [[nodiscard]] bool active() const noexcept { return drag_ != Drag::kNone; }

 private:
  Drag drag_ = Drag::kNone;
  bool split_line_ = false;
};

}  // namespace fettle::app
