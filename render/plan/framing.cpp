#include "render/plan/framing.h"

#include <algorithm>

namespace fettle::render {

Camera Framing::camera(const View& view) const {
  View fitted = view;
  fitted.zoom *= share;
  return Camera::fit(fitted, shown, drawn, plot);
}

double Framing::longerSide() const noexcept {
  return std::max(shown.high.x - shown.low.x, shown.high.y - shown.low.y);
}

void Framing::aimAt(const glm::dvec3& target, View& view) const noexcept {
  const auto share_of = [](double at, double low, double high) {
    return high > low ? (at - low) / (high - low) : 0.5;
  };
  view.centre_x = share_of(target.x, shown.low.x, shown.high.x);
  view.centre_y = share_of(target.y, shown.low.y, shown.high.y);
  view.centre_z = longerSide() > 0.0 ? (target.z - middle().z) / longerSide() : 0.0;
}

}  // namespace fettle::render
