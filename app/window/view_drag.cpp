#include "app/window/view_drag.h"

#include <algorithm>
#include <cmath>

namespace fettle::app {
namespace {

using render::InputKind;
using render::MouseButton;

constexpr double kSplitGrip_px = 8.0;

Drag dragOf(const render::InputEvent& event, Habits habits, bool tool_on) {
  const render::Modifiers& m = event.modifiers;
  switch (event.button) {
    case MouseButton::kLeft:
      if (m.alt) return Drag::kTurn;
      if (tool_on) return Drag::kNone;
      return m.shift ? Drag::kPan : Drag::kTurn;
    case MouseButton::kMiddle:
      if (habits == Habits::kBlender && m.shift) return Drag::kPan;
      if (habits == Habits::kBlender && m.control) return Drag::kZoom;
      return Drag::kTurn;
    case MouseButton::kRight:
      return Drag::kPan;
    case MouseButton::kOther:
      break;
  }
  return Drag::kNone;
}

}  // namespace

void ViewDrag::stop() noexcept {
  drag_ = Drag::kNone;
  split_line_ = false;
}

void ViewDrag::handle(const render::InputEvent& event, const glm::dvec2& from, bool tool_on,
                      const Scope& scope) {
  render::View& view = scope.view;
  Display& display = scope.settings.display;
  const double dx = event.x - from.x, dy = event.y - from.y;
  const double pixels_per_mm = scope.picture.pixelsPerMm();
  const bool on_picture = !event.panels_mouse && scope.picture.inside(event.x, event.y);
  switch (event.kind) {
    case InputKind::kButtonDown: {
      if (!on_picture) return;
      const render::Rectangle plot = scope.picture.plot(view, display);
      const double split_px = plot.x + display.split_at * plot.width;
      if (scope.picture.hasSplitLine(display) && event.button == MouseButton::kLeft &&
          std::abs(event.x - split_px) <= kSplitGrip_px)
        split_line_ = true;
      else
        drag_ = dragOf(event, scope.settings.habits, tool_on);
      break;
    }
    case InputKind::kButtonUp:
      stop();
      break;
    case InputKind::kMove:
      if (split_line_) {
        const render::Rectangle plot = scope.picture.plot(view, display);
        display.split_at = std::clamp((event.x - plot.x) / std::max(plot.width, 1), 0.02, 0.98);
      } else if (drag_ == Drag::kTurn) {
        Navigation::turn(view, dx, dy, scope.area.width);
      } else if (drag_ == Drag::kPan) {
        Navigation::pan(view, scope.grid, dx, dy, pixels_per_mm);
      } else if (drag_ == Drag::kZoom) {
        Navigation::zoom(view, scope.grid, -0.05 * dy, 0.0, 0.0, pixels_per_mm);
      }
      break;
    case InputKind::kWheel:
      if (!on_picture) return;
      Navigation::zoom(view, scope.grid, event.wheel, event.x - (scope.area.x + 0.5 * scope.area.width),
                       event.y - (scope.area.y + 0.5 * scope.area.height), pixels_per_mm);
      // Each of several steps between two frames starts from the result of the one before.
      scope.picture.zoomed(std::pow(1.15, event.wheel));
      break;
    default:
      break;
  }
}

}  // namespace fettle::app
