#include "app/window/brush_adjustment.h"

#include <cmath>
#include <cstdlib>

#include "app/window/scene_edits.h"

namespace fettle::app {
namespace {

using render::InputKind;
using render::Key;

constexpr double kRadius_px = 8.0;  // of cursor movement for one sample of radius
constexpr double kDepth_px = 20.0;  // ... for a tenth of the largest depth

}  // namespace

void BrushAdjustment::begin(Of of, LoopClient& client, double cursor_x) {
  const haptic::MouseStylus* const mouse = client.mouse();
  if (of == Of::kDepth && mouse == nullptr) return;
  of_ = of;
  press_mm_ = mouse != nullptr ? mouse->pressMm() : 0.0;
  from_ = of == Of::kRadius ? brushRadius(client) : press_mm_;
  from_x_ = cursor_x;
  typed_.clear();
}

void BrushAdjustment::set(LoopClient& client, double value, std::vector<Notice>& notices) const {
  of_ == Of::kRadius ? setBrushRadius(client, value, notices) : setPressDepth(client, value);
}

void BrushAdjustment::end() {
  of_ = Of::kNothing;
  typed_.clear();
}

void BrushAdjustment::leave(LoopClient& client, std::vector<Notice>& notices) {
  if (active()) set(client, from_, notices);
  end();
}

// Whether the key belongs to a number.
bool BrushAdjustment::typeKey(Key key) {
  const int code = static_cast<int>(key), keypad0 = static_cast<int>(Key::kKeypad0);
  if (code >= '0' && code <= '9')
    typed_ += static_cast<char>(code);
  else if (code >= keypad0 && code <= keypad0 + 9)
    typed_ += static_cast<char>('0' + code - keypad0);
  else if (key == Key::kPeriod || key == Key::kKeypadPeriod)
    typed_ += '.';
  else if (key == Key::kBackspace && !typed_.empty())
    typed_.pop_back();
  else
    return false;
  return true;
}

bool BrushAdjustment::handle(const render::InputEvent& event, LoopClient& client,
                             std::vector<Notice>& notices) {
  switch (event.kind) {
    case InputKind::kMove: {
      if (!typed_.empty()) return true;
      const double moved_px = event.x - from_x_;
      const double change =
          of_ == Of::kRadius ? std::round(moved_px / kRadius_px) : moved_px / kDepth_px * 0.1 * press_mm_;
      set(client, from_ + change, notices);
      return true;
    }
    case InputKind::kButtonDown:
      if (event.button == render::MouseButton::kRight) set(client, from_, notices);
      end();
      return true;
    case InputKind::kKeyDown:
      if (typeKey(event.key)) {
        if (!typed_.empty()) set(client, std::strtod(typed_.c_str(), nullptr), notices);
        return true;
      }
      if (event.key == Key::kEnter || event.key == Key::kKeypadEnter) {
        end();
        return true;
      }
      leave(client, notices);
      return event.key == Key::kEscape;
    default:
      return event.kind != InputKind::kWheel;
  }
}

}  // namespace fettle::app
