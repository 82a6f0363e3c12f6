#include "app/window/stylus.h"

#include <utility>

namespace fettle::app {
namespace {

using haptic::Tool;
using render::InputKind;
using render::MouseButton;

}  // namespace

void Stylus::choose(std::optional<Tool> tool, LoopClient& client, const WindowPicture& picture,
                    const glm::dvec2& cursor) {
  on_ = tool.has_value();
  turned_.reset();
  client.setTool(tool.value_or(Tool::kFeel));
  if (client.mouse() == nullptr) return;
  if (!on_) {
    lift(*client.mouse());
  } else if (picture.inside(cursor.x, cursor.y)) {
    under_cursor_ = picture.pick(cursor.x, cursor.y);
    if (under_cursor_) client.mouse()->setCursor(under_cursor_->position_mm);
  }
}

void Stylus::lift(haptic::MouseStylus& mouse) {
  mouse.release();
  mouse.leave();
  held_ = false;
}

void Stylus::turnBack(LoopClient& client) {
  if (turned_) client.setTool(*std::exchange(turned_, std::nullopt));
}

void Stylus::release(LoopClient* client) {
  held_ = false;
  if (client == nullptr) return;
  if (client->mouse() != nullptr) lift(*client->mouse());
  turnBack(*client);
}

void Stylus::follow(bool shift, bool touches, LoopClient& client) {
  // A tool that changed under the pressing hand would be no stroke of its own.
  if (client.mouse() != nullptr || touches) return;
  if (shift && on_ && !turned_ && client.tool() != Tool::kSmooth) {
    turned_ = client.tool();
    client.setTool(Tool::kSmooth);
  } else if (!shift) {
    turnBack(client);
  }
}

void Stylus::handle(const render::InputEvent& event, LoopClient& client, const WindowPicture& picture,
                    Hands hands, const std::optional<haptic::PenHold>& pen) {
  if (client.mouse() == nullptr) return;
  haptic::MouseStylus& mouse = *client.mouse();
  if (!on_ || hands == Hands::kNone) {
    lift(mouse);
    return;
  }
  if (event.kind == InputKind::kButtonUp && event.button == MouseButton::kLeft) {
    mouse.release();
    held_ = false;
    turnBack(client);
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
  mouse.hold(pen);
  mouse.setCursor(under_cursor_->position_mm);
  if (event.kind == InputKind::kButtonDown && event.button == MouseButton::kLeft && !event.modifiers.alt)
    press(event, client);
}

void Stylus::press(const render::InputEvent& event, LoopClient& client) {
  held_ = true;
  const Tool chosen = turned_.value_or(client.tool());
  const bool opposite = event.modifiers.control != (event.pen && event.pen->eraser);
  const Tool tool = opposite                ? haptic::rowOf(chosen).opposite
                    : event.modifiers.shift ? Tool::kSmooth
                                            : chosen;
  if (tool != client.tool()) {
    turned_ = client.tool();
    client.setTool(tool);
  }
  client.mouse()->press(tool);
}

}  // namespace fettle::app
