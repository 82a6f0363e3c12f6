#pragma once

#include <cstdint>
#include <optional>

#include <glm/vec2.hpp>

#include "app/window/marking.h"
#include "app/window/window_picture.h"
#include "render/live/live_picture.h"

namespace fettle::app {

inline constexpr double kGrip_px = 10.0;  ///< within which a line is under the cursor
inline constexpr double kClick_px = 3.0;  ///< a longer movement is no click

/// The mouse at the camera: buttons turn, move and zoom the view, the wheel zooms, and a handle moves the
/// line between two versions. A drag keeps hold of what was under the cursor when it began: that stays where it is
/// while the view turns and zooms, and under the cursor while it pans. Threading: main.
class ViewDrag {
 public:
  /// The environment of the drag.
  struct Scope {
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
  void press(const render::InputEvent& event, bool tool_on, const Scope& scope);

  Drag drag_ = Drag::kNone;
  std::optional<render::Grip> grip_;  // with drag_
  bool split_line_ = false;
};

/// A click of the left button in the picture: pressed and let go at one place. The events are for others, too: a drag turns the view.
/// Threading: main.
class PictureClick {
 public:
  /// True when the event completes one.
  [[nodiscard]] bool completes(const render::InputEvent& event, const WindowPicture& picture) noexcept;

 private:
  std::optional<glm::dvec2> pressed_;
};

/// Edge lines under the cursor: a click chooses the line (where no tool is on), Ctrl+Shift and the left button drag it.
/// Threading: main.
class LineDrag {
 public:
  struct Scope {
    LoopClient& client;
    const WindowPicture& picture;
    Marking& marking;
    bool tool_on;
    bool lines_are_shown;
  };

  /// Whether the press of a button begins a drag, whatever else it would do.
  [[nodiscard]] static bool begins(const render::InputEvent& event) noexcept {
    return event.kind == render::InputKind::kButtonDown && event.button == render::MouseButton::kLeft &&
           event.modifiers.control && event.modifiers.shift && !event.modifiers.alt;
  }
  /// Whether it used the event; a click is passed on, for it may turn the view, too.
  bool handle(const render::InputEvent& event, const Scope& scope);
  [[nodiscard]] bool active() const noexcept { return dragged_.has_value(); }
  void stop() noexcept {
    dragged_.reset();
    click_.reset();
  }

  /// Adds the thread from where the line was held to the cursor.
  void append(const engine::Version& field, render::Overlays& overlays) const;

 private:
  [[nodiscard]] static std::optional<glm::dvec2> placeOf(const render::InputEvent& event, const Scope& scope);

  std::optional<std::int64_t> dragged_;
  glm::dvec2 from_{0.0}, to_{0.0};   // [samples]
  std::optional<glm::dvec2> click_;  // [pixels] where the button went down
};

}  // namespace fettle::app
