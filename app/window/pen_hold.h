#pragma once

#include "haptic/devices/virtual/mouse_stylus.h"
#include "render/plan/camera.h"
#include "render/window/pen.h"

namespace fettle::app {

/// What the pressure of a tablet's pen does.
struct PenUse {
  static constexpr double kSoftest = 0.25, kFirmest = 4.0;
  bool presses = true;  ///< as deep as the hand presses; else always to the depth of the mouse
  /// Exponent on the pressure, kSoftest .. kFirmest: above 1 the hand has to press more for the same depth.
  double firmness = 1.0;
};

/// How a pen is held over the field: as it leans over its tablet it leans over the picture, whose directions are `axes`.
[[nodiscard]] haptic::PenHold penHold(const render::Pen& pen, const PenUse& use,
                                      const render::ViewAxes& axes);

}  // namespace fettle::app
