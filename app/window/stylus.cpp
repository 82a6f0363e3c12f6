#include "app/window/stylus.h"

#include <utility>

namespace fettle::app {
namespace {

using haptic::Tool;
using render::InputKind;
using render::MouseButton;

}  // namespace

void Stylus::choose(std::optional<Tool> tool, LoopClient& touch, const WindowPicture& picture,
                    const glm::dvec2& cursor) {
  on_ = tool.has_value();
  turned_.reset();
  touch.setTool(tool.value_or(Tool::kFeel));
  if (touch.mouse() == nullptr) return;
  if (!on_) {
    lift(*touch.mouse());
  } else if (picture.inside(cursor.x, cursor.y)) {
    under_cursor_ = picture.pick(cursor.x, cursor.y);
    if (under_cursor_) touch.mouse()->setCursor(under_cursor_->position_mm);
  }
}

void Stylus::lift(haptic::MouseStylus& mouse) {
  mouse.release();
  mouse.leave();
  held_ = false;
}

void Stylus::turnBack(LoopClient& touch) {
  if (turned_) touch.setTool(*std::exchange(turned_, std::nullopt));
}

void Stylus::release(LoopClient* touch) {
  held_ = false;
  if (touch == nullptr) return;
  if (touch->mouse() != nullptr) lift(*touch->mouse());
  turnBack(*touch);
}

void Stylus::handle(const render::InputEvent& event, LoopClient& touch, const WindowPicture& picture,
                    Hands hands) {
  if (touch.mouse() == nullptr) return;
  haptic::MouseStylus& mouse = *touch.mouse();
  if (!on_ || hands == Hands::kNone) {
    lift(mouse);
    return;
  }
  if (event.kind == InputKind::kButtonUp && event.button == MouseButton::kLeft) {
    mouse.release();
    held_ = false;
    turnBack(touch);
    return;
  }
  if (event.kind == InputKind::kLeave) {
    if (!held_) mouse.leave();
    return;
  }
  if (event.kind != InputKind::kMove && event.kind != InputKind::kButtonDown) return;
  if (!picture.made()) return;  // the device is lost: the stylus stays where it is
  if (hands == Hands::kOther) return;
  if (!picture.inside(event.x, event.y) || (event.panels_mouse && !held_)) {
    mouse.leave();
    return;
  }
  under_cursor_ = picture.pick(event.x, event.y);
  if (!under_cursor_) {
    mouse.leave();
    return;
  }
  mouse.setCursor(under_cursor_->position_mm);
  if (event.kind == InputKind::kButtonDown && event.button == MouseButton::kLeft && !event.modifiers.alt)
    press(event, touch);
}

void Stylus::press(const render::InputEvent& event, LoopClient& touch) {
  held_ = true;
  const Tool chosen = turned_.value_or(touch.tool());
  const Tool tool = event.modifiers.control ? haptic::rowOf(chosen).opposite : chosen;
  if (tool != touch.tool()) {
    turned_ = touch.tool();
    touch.setTool(tool);
  }
  touch.mouse()->press(tool);
}

}  // namespace fettle::app
