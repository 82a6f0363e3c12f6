#include "app/window/input.h"

#include <algorithm>
#include <utility>

#include <imgui.h>

namespace fettle::app {
namespace {

using render::InputEvent;
using render::InputKind;
using render::Key;

bool linesAreShown(const Parts& parts) {
  const LoopClient* const client = parts.document.client();
  return client != nullptr && parts.settings.display.marks && client->field().lines() != nullptr;
}

SectionDrag::Scope sectionScope(Parts& parts, const LoopClient& client) {
  return {client.field(), parts.picture, parts.view, parts.section, parts.stylus.on()};
}

// Whether it clicks on an end of the axes, which lie over the surface.
bool pressesAxis(const InputEvent& event, const Parts& parts) {
  return event.kind == InputKind::kButtonDown && event.button == render::MouseButton::kLeft &&
         !event.panels_mouse && parts.axisAt({event.x, event.y}).has_value();
}

// Input that cannot wait for the next frame: the mouse as stylus.
void toStylus(const InputEvent& event, Parts& parts) {
  LoopClient* const client = parts.document.client();
  if (client == nullptr || parts.marking.lasso().active()) return;
  const Stylus::Hands hands = parts.feedback.questions.pending() ? Stylus::Hands::kNone
                              : parts.radial.active() || parts.drag.active() || pressesAxis(event, parts) ||
                                      parts.brush.active() || parts.line_drag.active() ||
                                      parts.section_drag.active() ||
                                      SectionDrag::begins(event, sectionScope(parts, *client)) ||
                                      (LineDrag::begins(event) && linesAreShown(parts))
                                  ? Stylus::Hands::kOther
                                  : Stylus::Hands::kFree;
  std::optional<haptic::PenHold> pen;
  if (event.pen) pen = penHold(*event.pen, parts.settings.pen, render::axesOf(parts.view));
  parts.stylus.handle(event, *client, parts.picture, hands, pen);
}

Input::Request handleKey(const InputEvent& event, Parts& parts) {
  Questions& questions = parts.feedback.questions;
  if (questions.pending()) {
    questions.press(event);
    return {};
  }
  if (event.panels_key && !questions.justClosed()) return {};  // a text field has it
  if (event.modifiers == render::Modifiers{true, false, false} && event.key >= render::letter('1') &&
      event.key <= render::letter('9')) {
    const auto n = static_cast<std::size_t>(static_cast<int>(event.key) - '1');
    const std::vector<std::string>& recent = parts.recent.paths();
    return n < recent.size() ? Input::Request{std::nullopt, recent[n]} : Input::Request{};
  }
  const std::optional<Action> action = actionOf(event.key, event.modifiers);
  if (event.repeat && action == Action::kShowBefore) return {};  // it is held
  return {action, std::nullopt};
}

// The wheel sets the press depth of the stylus.
bool pressesDeeper(const InputEvent& event, const Parts& parts) {
  LoopClient* const client = parts.document.client();
  return event.kind == InputKind::kWheel && client != nullptr && client->mouse() != nullptr &&
         parts.stylus.on() && (parts.stylus.held() || event.modifiers.control);
}

// The second button of the mouse as stylus, where the user's habits leave it free.
bool opensRadialMenu(const InputEvent& event, const Parts& parts) {
  LoopClient* const client = parts.document.client();
  return event.kind == InputKind::kButtonDown && event.button == render::MouseButton::kRight &&
         !event.panels_mouse && client != nullptr && client->mouse() != nullptr && parts.stylus.on() &&
         !parts.stylus.held() && parts.picture.inside(event.x, event.y) &&
         dragOf(event.button, event.modifiers, parts.settings.habits, true) == Drag::kNone;
}

}  // namespace

// Before the event waits for the current frame, for a dialog or for a tool.
void Input::disarmAtOnce(const InputEvent& event, Parts& parts) {
  if (!parts.document.isOpen() || event.kind != InputKind::kKeyDown) return;
  const Questions& questions = parts.feedback.questions;
  const bool typing = ImGui::GetIO().WantTextInput && (questions.pending() || !questions.justClosed());
  if (!disarms(event.key, event.modifiers, typing ? Typing::kYes : Typing::kNo)) return;
  parts.document.client()->disarm();
  // Keys pressed earlier but not processed yet must not arm after it.
  for (Pending& before : queue_)
    if (actionOf(before.event.key, before.event.modifiers) == Action::kArm) before.event.key = Key::kNone;
}

void Input::add(const InputEvent& happened, Parts& parts) {
  InputEvent event = happened;
  // The second press of a double click on an entry of a menu that lay over the picture.
  event.panels_mouse =
      event.panels_mouse || (event.kind == InputKind::kButtonDown &&
                             parts.list_press.repeats(event.x, event.y, ListPress::Clock::now()));
  const bool at_once = std::none_of(queue_.begin(), queue_.end(), [](const Pending& pending) {
    return pending.event.kind == InputKind::kKeyDown;
  });
  disarmAtOnce(event, parts);
  if (at_once) toStylus(event, parts);
  queue_.push_back({event, at_once});
}

void Input::followSurface(Parts& parts) const {
  if (!parts.stylus.held() || !queue_.empty()) return;
  InputEvent here;
  here.kind = InputKind::kMove;
  here.x = parts.cursor.x;
  here.y = parts.cursor.y;
  here.pen = parts.window.pen();  // it may press harder without moving
  toStylus(here, parts);
}

std::optional<InputEvent> Input::next(Parts& parts) {
  if (queue_.empty() || parts.feedback.questions.answering()) return std::nullopt;
  const Pending pending = queue_.front();
  queue_.pop_front();
  const InputEvent& event = pending.event;
  acted_ = acted_ || event.kind != InputKind::kMove;
  counts_.keys += event.kind == InputKind::kKeyDown;
  counts_.buttons += event.kind == InputKind::kButtonDown || event.kind == InputKind::kButtonUp;
  counts_.wheels += event.kind == InputKind::kWheel;
  if (!pending.stylus_has_it) toStylus(event, parts);
  const bool shows = event.kind == InputKind::kKeyUp  ? parts.radial.active()
                     : event.kind == InputKind::kMove ? !event.panels_mouse || ImGui::IsAnyMouseDown()
                                                      : true;
  if (shows) parts.picture.requestRedraw();
  return event;
}

Input::Request Input::handle(const InputEvent& event, Parts& parts) {
  LoopClient* const client = parts.document.client();
  const bool dialog = parts.feedback.questions.pending();
  if (parts.radial.active()) {
    const RadialMenu::Outcome outcome = parts.radial.handle(event);
    if (outcome.used) return {outcome.chosen, std::nullopt};
  }
  if (event.kind == InputKind::kKeyUp) {
    if (event.key == rowOf(Action::kShowBefore).key && std::exchange(parts.shows_before, false))
      parts.picture.requestRedraw();
    return {};
  }
  if (client != nullptr && parts.brush.active() && parts.brush.handle(event, *client, parts.feedback.notices))
    return {};
  if (client != nullptr && parts.marking.lasso().active() && !dialog &&
      parts.marking.handle(event,
                           {*client, parts.picture, parts.view, parts.settings.display, parts.drag.active()}))
    return {};
  if (event.kind == InputKind::kKeyDown) {
    // What a key begins is not for a hand that holds a line.
    const bool dragging = parts.line_drag.active() || parts.section_drag.active();
    parts.line_drag.stop();
    if (event.key == Key::kEscape)
      parts.section_drag.cancel(parts.section);
    else
      parts.section_drag.stop();
    return dragging && event.key == Key::kEscape ? Request{} : handleKey(event, parts);
  }
  if (!dialog && pressesAxis(event, parts)) return {parts.axisAt({event.x, event.y}), std::nullopt};
  if (client != nullptr && !dialog && !parts.marking.lasso().active() &&
      parts.section_drag.handle(event, sectionScope(parts, *client)))
    return {};
  if (client != nullptr && !dialog && !parts.marking.lasso().active() &&
      parts.line_drag.handle(
          event, {*client, parts.picture, parts.marking, parts.stylus.on(), linesAreShown(parts)}))
    return {};
  if (parts.seenGrid() == nullptr || dialog) return {};
  const bool clicked = parts.plane_click.completes(event, parts.picture);
  if (client != nullptr && pressesDeeper(event, parts)) {
    if (!event.panels_mouse && parts.picture.inside(event.x, event.y)) client->mouse()->wheel(event.wheel);
    return {};
  }
  if (opensRadialMenu(event, parts)) {
    parts.radial.open({event.x, event.y}, parts.window.pictureArea(), parts.window.scale(),
                      RadialMenu::By::kButton);
    return {};
  }
  const render::View before = parts.view;
  parts.drag.handle(event, parts.cursor, parts.stylus.on(),
                    {parts.window.pictureArea(), parts.picture, parts.view, parts.settings});
  // A hand at the view ends a flight where it is.
  if (parts.drag.active() || !(parts.view == before)) parts.flight.stop();
  if (clicked && parts.plane_points.next()) return {Action::kPlanePoint, std::nullopt};
  return {};
}

}  // namespace fettle::app
