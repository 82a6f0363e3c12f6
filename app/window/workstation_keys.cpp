#include "app/window/workstation.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <imgui.h>

namespace fettle::app {
namespace {

using render::InputEvent;
using render::InputKind;
using render::Key;
using render::MouseButton;

constexpr double kRadius_px = 8.0;  // of the cursor's way for one sample of radius
constexpr double kDepth_px = 20.0;  // ... for a tenth of the deepest press

}  // namespace

// Before the event waits for the frame under way, for a dialog or for a tool.
void Workstation::disarmAtOnce(const InputEvent& event) {
  if (!touch_ || event.kind != InputKind::kKeyDown) return;
  // For two frames ImGui still says so of the field of a dialog that was closed.
  const bool typing = ImGui::GetIO().WantTextInput && (questions_.pending() || frames_ > question_frame_ + 3);
  if (!disarms(event.key, event.modifiers, typing ? Typing::kYes : Typing::kNo)) return;
  touch_->disarm();
  // What was pressed before and is not done yet must not arm after it.
  for (Pending& before : input_)
    if (actionOf(before.event.key, before.event.modifiers) == Action::kArm) before.event.key = Key::kNone;
}

void Workstation::handleKey(const InputEvent& event) {
  if (questions_.pending()) {
    questions_.press(event);
    return;
  }
  // A text field has it; for two frames ImGui still says so of the field of a dialog that was closed.
  if (event.panels_key && frames_ > question_frame_ + 3) return;
  const auto action = actionOf(event.key, event.modifiers);
  if (event.modifiers == render::Modifiers{true, false, false} && event.key >= render::letter('1') &&
      event.key <= render::letter('9')) {
    const auto n = static_cast<std::size_t>(static_cast<int>(event.key) - '1');
    if (n < recent_.paths().size()) askToOpen(recent_.paths()[n]);
    return;
  }
  if (action) act(*action);
}

void Workstation::setAdjusted(double value) {
  adjusting_ == Adjusting::kRadius ? setBrushRadius(value) : setPressDepth(value);
}

// As it was before.
void Workstation::leaveAdjusting() {
  if (adjusting_ != Adjusting::kNothing) setAdjusted(adjust_from_);
  adjusting_ = Adjusting::kNothing;
  typed_.clear();
}

// F and Shift+F: move or type, confirm with the left button or Enter, leave with the right one or Esc.
bool Workstation::handleAdjusting(const InputEvent& event) {
  const bool radius = adjusting_ == Adjusting::kRadius;
  const auto end = [&] {
    adjusting_ = Adjusting::kNothing;
    typed_.clear();
  };
  switch (event.kind) {
    case InputKind::kMove: {
      if (!typed_.empty()) return true;
      const double way = event.x - adjust_x_;
      setAdjusted(adjust_from_ + (radius ? std::round(way / kRadius_px) : way / kDepth_px * 0.1 * press_mm_));
      return true;
    }
    case InputKind::kButtonDown:
      if (event.button == MouseButton::kRight) setAdjusted(adjust_from_);
      end();
      return true;
    case InputKind::kKeyDown: {
      const int code = static_cast<int>(event.key);
      const int keypad0 = static_cast<int>(Key::kKeypad0);
      if (code >= '0' && code <= '9') {
        typed_ += static_cast<char>(code);
      } else if (code >= keypad0 && code <= keypad0 + 9) {
        typed_ += static_cast<char>('0' + code - keypad0);
      } else if (event.key == Key::kPeriod || event.key == Key::kKeypadPeriod) {
        typed_ += '.';
      } else if (event.key == Key::kBackspace && !typed_.empty()) {
        typed_.pop_back();
      } else if (event.key == Key::kEnter || event.key == Key::kKeypadEnter) {
        end();
        return true;
      } else {
        leaveAdjusting();
        return event.key == Key::kEscape;
      }
      if (!typed_.empty()) setAdjusted(std::strtod(typed_.c_str(), nullptr));
      return true;
    }
    default:
      return event.kind != InputKind::kWheel;
  }
}

}  // namespace fettle::app
