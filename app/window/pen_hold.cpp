#include "app/window/pen_hold.h"

#include <algorithm>
#include <cmath>

#include <glm/trigonometric.hpp>

namespace fettle::app {

// No pen lies flat: its hand would be infinitely far aside.
constexpr double kFlattest_deg = 85.0;

haptic::PenHold penHold(const render::Pen& pen, const PenUse& use, const render::ViewAxes& axes) {
  haptic::PenHold hold;
  if (use.presses) hold.share = std::pow(std::clamp(pen.pressure, 0.0, 1.0), use.firmness);
  if (!pen.tilt_deg) return hold;
  const auto lean = [](double deg) {
    return std::tan(glm::radians(std::clamp(deg, -kFlattest_deg, kFlattest_deg)));
  };
  hold.to_hand =
      glm::normalize(lean(pen.tilt_deg->x) * axes.right - lean(pen.tilt_deg->y) * axes.up + axes.to_viewer);
  return hold;
}

}  // namespace fettle::app
