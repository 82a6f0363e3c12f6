#include "app/window/brush_adjustment.h"

#include <cmath>

#include "app/window/scene_edits.h"
#include "app/work/typed_number.h"

namespace fettle::app {
namespace {

using render::InputKind;
using render::Key;

constexpr double kRadius_px = 8.0;  // of cursor movement for one sample of radius
constexpr double kDepth_px = 20.0;  // ... for a tenth of the largest depth

}  // namespace

void BrushAdjustment::begin(Of of, LoopClient& client, const render::ShownUnit& height, double cursor_x) {
  const haptic::MouseStylus* const mouse = client.mouse();
  if (of == Of::kDepth && mouse == nullptr) return;
  of_ = of;
  press_mm_ = mouse != nullptr ? mouse->pressMm() : 0.0;
  from_ = of == Of::kRadius ? brushRadius(client) : press_mm_;
  from_x_ = cursor_x;
  depth_ = ofMillimetres(height, client.field().grid().height_unit.mm);
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

std::optional<double> BrushAdjustment::valueTyped() const {
  if (of_ == Of::kDepth) {
    const auto shown = readTypedLength(typed_, depth_.name);
    return shown ? std::optional(*shown / depth_.per_unit) : std::nullopt;
  }
  const auto typed = readTypedNumber(typed_);
  return typed && typed->unit.empty() ? std::optional(typed->number) : std::nullopt;
}

// Whether the key belongs to a number, or to a unit behind it.
bool BrushAdjustment::typeKey(const render::InputEvent& event) {
  if (event.modifiers.control || event.modifiers.alt) return false;
  const Key key = event.key;
  const int code = static_cast<int>(key), keypad0 = static_cast<int>(Key::kKeypad0);
  if (code >= '0' && code <= '9')
    typed_ += static_cast<char>(code);
  else if (code >= keypad0 && code <= keypad0 + 9)
    typed_ += static_cast<char>('0' + code - keypad0);
  else if (key == Key::kPeriod || key == Key::kKeypadPeriod)
    typed_ += '.';
  else if (key == Key::kComma)
    typed_ += ',';
  else if (of_ == Of::kDepth && !typed_.empty() && code >= 'A' && code <= 'Z')
    typed_ += static_cast<char>(code - 'A' + 'a');
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
      if (typeKey(event)) {
        if (const auto value = valueTyped()) set(client, *value, notices);
        return true;
      }
      if (event.key == Key::kEnter || event.key == Key::kKeypadEnter) {
        if (understood()) end();
        return true;
      }
      leave(client, notices);
      return event.key == Key::kEscape;
    default:
      return event.kind != InputKind::kWheel;
  }
}

}  // namespace fettle::app
