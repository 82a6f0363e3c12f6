#include <algorithm>
#include <cmath>

#include <imgui.h>

#include "app/window/workstation.h"

namespace fettle::app {
namespace {

using render::InputEvent;
using render::InputKind;
using render::MouseButton;

constexpr double kSplitGrip_px = 8.0;

}  // namespace

bool Workstation::inPicture(double x, double y) const {
  const render::Rectangle& area = window_->pictureArea();
  return x >= area.x && y >= area.y && x < area.x + area.width && y < area.y + area.height;
}

std::optional<render::Picked> Workstation::pick(double x, double y) const {
  const render::Rectangle& area = window_->pictureArea();
  // A lost device takes its picture with it.
  return picture_ ? picture_->pick(x - area.x, y - area.y) : std::nullopt;
}

// What cannot wait for the next frame: the mouse as stylus.
void Workstation::toStylus(const InputEvent& event) {
  if (!touch_ || touch_->mouse() == nullptr) return;
  haptic::MouseStylus& mouse = *touch_->mouse();
  if (lasso_.active()) return;
  if (!tool_on_ || questions_.pending()) {
    mouse.release();
    mouse.leave();
    stylus_held_ = false;
    return;
  }
  if (event.kind == InputKind::kButtonUp && event.button == MouseButton::kLeft) {
    mouse.release();
    stylus_held_ = false;
    if (turned_tool_) touch_->setTool(*std::exchange(turned_tool_, std::nullopt));
    return;
  }
  if (event.kind == InputKind::kLeave) {
    if (!stylus_held_) mouse.leave();
    return;
  }
  if (event.kind != InputKind::kMove && event.kind != InputKind::kButtonDown) return;
  if (!picture_) return;  // the device is lost: the stylus stays where it is
  if (drag_ != Drag::kNone || adjusting_ != Adjusting::kNothing) return;
  if (!inPicture(event.x, event.y) || (event.panels_mouse && !stylus_held_)) {
    mouse.leave();
    return;
  }
  under_cursor_ = pick(event.x, event.y);
  if (under_cursor_)
    mouse.setCursor(under_cursor_->position_mm);
  else
    mouse.leave();
  if (event.kind == InputKind::kButtonDown && event.button == MouseButton::kLeft && !event.modifiers.alt &&
      under_cursor_) {
    stylus_held_ = true;
    const haptic::Tool tool = toolFor(event.modifiers);
    if (tool != touch_->tool()) {
      turned_tool_ = touch_->tool();
      touch_->setTool(tool);
    }
    mouse.press(tool);
  }
}

void Workstation::handleInput() {
  // What is under a cursor at rest sinks while it is smoothed: the stylus goes with it.
  if (stylus_held_ && input_.empty()) {
    InputEvent here;
    here.kind = InputKind::kMove;
    here.x = last_x_;
    here.y = last_y_;
    toStylus(here);
  }
  std::vector<Pending> done = std::exchange(input_, {});
  for (auto next = done.begin(); next != done.end(); ++next) {
    // What comes after an answer is about what that leads to: it waits for the frame that does it.
    if (questions_.answering()) {
      input_.insert(input_.begin(), std::make_move_iterator(next), std::make_move_iterator(done.end()));
      break;
    }
    const auto& [event, stylus_has_it] = *next;
    countHand(event);
    if (!stylus_has_it) toStylus(event);
    if (event.kind != InputKind::kMove || !event.panels_mouse || ImGui::IsAnyMouseDown()) stale_ = true;
    handle(event);
    last_x_ = event.x;
    last_y_ = event.y;
  }
}

// Takes the hands off everything: what is held is let go, what was not confirmed is left.
void Workstation::letGo() {
  drag_ = Drag::kNone;
  dragging_split_ = false;
  stylus_held_ = false;
  leaveAdjusting();
  if (!touch_) return;
  if (touch_->mouse() != nullptr) {
    touch_->mouse()->release();
    touch_->mouse()->leave();
  }
  if (turned_tool_) touch_->setTool(*std::exchange(turned_tool_, std::nullopt));
}

Drag Workstation::dragOf(const InputEvent& event) const {
  const render::Modifiers& m = event.modifiers;
  switch (event.button) {
    case MouseButton::kLeft:
      if (m.alt) return Drag::kTurn;
      if (tool_on_) return Drag::kNone;
      return m.shift ? Drag::kPan : Drag::kTurn;
    case MouseButton::kMiddle:
      if (habits_ == Habits::kBlender && m.shift) return Drag::kPan;
      if (habits_ == Habits::kBlender && m.control) return Drag::kZoom;
      return Drag::kTurn;
    case MouseButton::kRight:
      return Drag::kPan;
    case MouseButton::kOther:
      break;
  }
  return Drag::kNone;
}

void Workstation::handle(const InputEvent& event) {
  if (adjusting_ != Adjusting::kNothing && handleAdjusting(event)) return;
  if (touch_ && lasso_.active() && !questions_.pending() && handleLasso(event)) return;
  if (event.kind == InputKind::kKeyDown) {
    handleKey(event);
    return;
  }
  const engine::Grid* const seen = seenGrid();
  if (seen == nullptr || questions_.pending()) return;
  const engine::Grid& grid = *seen;
  const render::Rectangle& area = window_->pictureArea();
  const double dx = event.x - last_x_, dy = event.y - last_y_;
  const double split_px = plot().x + display_.split_at * plot().width;
  switch (event.kind) {
    case InputKind::kButtonDown:
      if (event.panels_mouse || !inPicture(event.x, event.y)) return;
      if (display_.split && display_.stereo == render::StereoMode::kOff && shown_.versions.size() == 2 &&
          event.button == MouseButton::kLeft && std::abs(event.x - split_px) <= kSplitGrip_px) {
        dragging_split_ = true;
        return;
      }
      drag_ = dragOf(event);
      break;
    case InputKind::kButtonUp:
      drag_ = Drag::kNone;
      dragging_split_ = false;
      break;
    case InputKind::kMove:
      if (dragging_split_)
        display_.split_at = std::clamp((event.x - plot().x) / std::max(plot().width, 1), 0.02, 0.98);
      else if (drag_ == Drag::kTurn)
        Navigation::turn(view_, dx, dy, area.width);
      else if (drag_ == Drag::kPan)
        Navigation::pan(view_, grid, dx, dy, figures_.pixels_per_mm);
      else if (drag_ == Drag::kZoom)
        Navigation::zoom(view_, grid, -0.05 * dy, 0.0, 0.0, figures_.pixels_per_mm);
      break;
    case InputKind::kWheel:
      if (event.panels_mouse || !inPicture(event.x, event.y)) return;
      if (touch_ && touch_->mouse() != nullptr && tool_on_ && (stylus_held_ || event.modifiers.control)) {
        touch_->mouse()->wheel(event.wheel);
      } else {
        Navigation::zoom(view_, grid, event.wheel, event.x - (area.x + 0.5 * area.width),
                         event.y - (area.y + 0.5 * area.height), figures_.pixels_per_mm);
        // Several steps between two frames each start from what the one before made.
        figures_.pixels_per_mm *= std::pow(1.15, event.wheel);
      }
      break;
    default:
      break;
  }
}

}  // namespace fettle::app
