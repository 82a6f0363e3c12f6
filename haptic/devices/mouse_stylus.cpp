#include "haptic/devices/mouse_stylus.h"

#include <algorithm>
#include <cmath>

#include "haptic/devices/report_link.h"

namespace fettle::haptic {

MouseStylus::MouseStylus(const MouseFeel& feel) : feel_(feel) {
  profile_.name = "mouse";
  profile_.space = DeviceSpace::kField;
  profile_.workspace_radius_mm = 1e9;  // the field is its workspace
  profile_.max_force_n = 0.0;
  profile_.gives_force = false;
  wish_.press_mm = std::clamp(feel.press_mm, 0.0, feel.deepest_mm);
}

void MouseStylus::setCursor(const glm::dvec3& p) noexcept {
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
    leave();
    return;
  }
  wish_.surface_mm = p;
  wish_.over = true;
  slot_.publish(wish_);
}

void MouseStylus::leave() noexcept {
  wish_.over = false;
  slot_.publish(wish_);
}

void MouseStylus::setButton(Button button) noexcept {
  wish_.held = button == Button::kHeld;
  slot_.publish(wish_);
}

void MouseStylus::wheel(double steps) noexcept {
  if (!std::isfinite(steps)) return;
  wish_.press_mm = std::clamp(wish_.press_mm - steps * feel_.wheel_step_mm, 0.0, feel_.deepest_mm);
  slot_.publish(wish_);
}

DeviceInput MouseStylus::read() noexcept {
  return readAt(steadyNs());
}

DeviceInput MouseStylus::readAt(std::int64_t now_ns) noexcept {
  const double passed =
      last_read_ns_ == 0 ? 0.0 : std::max(1e-9 * static_cast<double>(now_ns - last_read_ns_), 0.0);
  last_read_ns_ = now_ns;
  slot_.take();
  const Wish& wish = slot_.latest();
  if (!wish.over && !placed_) return input_;  // never was over the field: not there yet

  const bool pressing = wish.over && wish.held;
  target_ = wish.surface_mm;
  target_.z += pressing ? -wish.press_mm : feel_.hover_mm;
  if (!placed_) {
    // Comes down from the hover height, wherever it first appears.
    input_.position_mm = wish.surface_mm + glm::dvec3{0.0, 0.0, feel_.hover_mm};
    placed_ = true;
  }
  // First-order follow, exact for any step: stable however late the loop is.
  input_.position_mm += (target_ - input_.position_mm) * -std::expm1(-passed / feel_.follow_s);
  input_.buttons = pressing ? kPrimaryButton : 0;
  input_.link = LinkState::kConnected;
  input_.arrival_ns = now_ns;
  ++input_.sequence;
  return input_;
}

}  // namespace fettle::haptic
