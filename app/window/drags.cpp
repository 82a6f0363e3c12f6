#include "app/window/drags.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "app/window/navigation.h"

namespace fettle::app {

namespace {

using render::InputKind;
using render::MouseButton;

constexpr double kSplitGrip_px = 8.0;

// Steps of the wheel per pixel of a drag that zooms.
constexpr double kZoomPerPixel = 0.05;

double gripOf(const engine::Grid& grid, const WindowPicture& picture) {
  return std::max(1.0, kGrip_px * picture.mmPerPixel() / std::min(grid.spacingXMm(), grid.spacingYMm()));
}

glm::dvec3 onSurface(const engine::Version& field, glm::dvec2 at) {
  const engine::Grid& grid = field.grid();
  const auto sample = [](double v, std::int32_t side) {
    return static_cast<std::int32_t>(std::clamp(v + 0.5, 0.0, side - 1.0));
  };
  const double z =
      static_cast<double>(field.reader().heightAt(sample(at.x, grid.width), sample(at.y, grid.height)));
  return {at.x * grid.spacingXMm(), at.y * grid.spacingYMm(), z == z ? z * grid.height_unit.mm : 0.0};
}

}  // namespace

void ViewDrag::stop() noexcept {
  drag_ = Drag::kNone;
  split_line_ = false;
}

void ViewDrag::press(const render::InputEvent& event, bool tool_on, const Scope& scope) {
  const Display& display = scope.settings.display;
  const render::Rectangle plot = scope.picture.plot(scope.view, display);
  const double split_px = plot.x + display.split_at * plot.width;
  if (scope.picture.hasSplitLine(display) && event.button == MouseButton::kLeft &&
      std::abs(event.x - split_px) <= kSplitGrip_px) {
    split_line_ = true;
    return;
  }
  grip_ = scope.picture.grip(event.x, event.y);
  drag_ = grip_ ? dragOf(event.button, event.modifiers, scope.settings.habits, tool_on) : Drag::kNone;
}

void ViewDrag::handle(const render::InputEvent& event, const glm::dvec2& from, bool tool_on,
                      const Scope& scope) {
  render::View& view = scope.view;
  Display& display = scope.settings.display;
  const glm::dvec2 moved(event.x - from.x, event.y - from.y);
  const bool on_picture = !event.panels_mouse && scope.picture.inside(event.x, event.y);
  switch (event.kind) {
    case InputKind::kButtonDown:
      if (on_picture) press(event, tool_on, scope);
      break;
    case InputKind::kButtonUp:
      stop();
      break;
    case InputKind::kMove:
      if (split_line_) {
        const render::Rectangle plot = scope.picture.plot(view, display);
        display.split_at = std::clamp((event.x - plot.x) / std::max(plot.width, 1), 0.02, 0.98);
      } else if (drag_ == Drag::kTurn) {
        Navigation::turnBy(view, grip_->framing, grip_->point, moved, scope.area.width);
      } else if (drag_ == Drag::kPan) {
        grip_->pixel += moved;
        Navigation::put(view, grip_->framing, grip_->point, grip_->pixel);
      } else if (drag_ == Drag::kZoom) {
        Navigation::zoomAt(view, grip_->framing, grip_->point, -kZoomPerPixel * moved.y);
      }
      break;
    case InputKind::kWheel:
      if (!on_picture) return;
      // Several steps between two frames all hold what the last frame shows there.
      if (const auto grip = scope.picture.grip(event.x, event.y))
        Navigation::zoomAt(view, grip->framing, grip->point, event.wheel);
      break;
    default:
      break;
  }
}

bool PictureClick::completes(const render::InputEvent& event, const WindowPicture& picture) noexcept {
  if (event.button != MouseButton::kLeft) return false;
  const glm::dvec2 at(event.x, event.y);
  if (event.kind == InputKind::kButtonDown) {
    const bool plain = event.modifiers == render::Modifiers{};
    pressed_ = plain && !event.panels_mouse && picture.inside(at.x, at.y) ? std::optional(at) : std::nullopt;
    return false;
  }
  if (event.kind != InputKind::kButtonUp) return false;
  const auto pressed = std::exchange(pressed_, std::nullopt);
  return pressed && glm::distance(*pressed, at) <= kClick_px;
}

std::optional<glm::dvec2> LineDrag::placeOf(const render::InputEvent& event, const Scope& scope) {
  if (event.panels_mouse || !scope.picture.inside(event.x, event.y)) return std::nullopt;
  const auto picked = scope.picture.pick(event.x, event.y);
  if (!picked) return std::nullopt;
  const engine::Grid& grid = scope.client.field().grid();
  return glm::dvec2(picked->position_mm) / glm::dvec2(grid.spacingXMm(), grid.spacingYMm());
}

bool LineDrag::handle(const render::InputEvent& event, const Scope& scope) {
  if (event.kind == InputKind::kMove && dragged_) {
    to_ = placeOf(event, scope).value_or(to_);
    return true;
  }
  if (event.button != MouseButton::kLeft) return false;
  LineTool& lines = scope.marking.lines;
  const double grip = gripOf(scope.client.field().grid(), scope.picture);
  if (event.kind == InputKind::kButtonDown && scope.lines_are_shown) {
    click_.reset();
    if (!begins(event)) {
      if (!scope.tool_on) click_ = {event.x, event.y};
      return false;
    }
    const auto place = placeOf(event, scope);
    if (!place) return true;
    dragged_ = LineTool::lineAt(scope.client, *place, grip);
    lines.choose(dragged_);
    from_ = to_ = *place;
    return true;
  }
  if (event.kind != InputKind::kButtonUp) return false;
  if (dragged_) {
    if (glm::distance(from_, to_) > 0.5) lines.drag(scope.marking.edit, *dragged_, from_, to_);
    dragged_.reset();
    return true;
  }
  if (click_ && glm::distance(*click_, {event.x, event.y}) <= kClick_px)
    if (const auto place = placeOf(event, scope))
      if (const auto id = LineTool::lineAt(scope.client, *place, grip)) lines.choose(id);
  click_.reset();
  return false;
}

void LineDrag::append(const engine::Version& field, render::Overlays& overlays) const {
  if (!dragged_) return;
  render::OverlayLine thread;
  thread.from_mm = onSurface(field, from_);
  thread.to_mm = onSurface(field, to_);
  thread.width_px = 3.0F;
  thread.colour = {1.0F, 1.0F, 0.25F};
  overlays.lines.push_back(thread);
}

}  // namespace fettle::app
