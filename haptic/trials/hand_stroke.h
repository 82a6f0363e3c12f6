#pragma once

#include <cstdint>
#include <vector>

#include "engine/field/version.h"
#include "haptic/base/strokes.h"

namespace fettle::trials {

/// A hand that moves over a whole field for a long time, for speed and end-to-end tests: sweeps along
/// Lissajous curves, presses and lifts a few times per second, trembles at 9 Hz. It does not model a user's
/// task.
struct HandMotion {
  std::int64_t ticks = 1'000'000;
  haptic::Tool tool = haptic::Tool::kFeel;
  double tick_s = 1e-3;
  double speed_mm_s = 50.0;  ///< along the sweep, about
  double press_mm = 0.3;     ///< deepest press below the surface
  double lift_mm = 0.05;     ///< highest lift above it
  double tremor_mm = 0.02;
};

/// The same motion over the same field gives the same strokes. Over holes it follows the last height.
[[nodiscard]] std::vector<haptic::StrokeSample> handStroke(const engine::Version& field,
                                                           const HandMotion& motion);

/// A field for such strokes: a milled part with steps, ribs and freeform areas, and noise of the given range;
/// `side` samples square.
[[nodiscard]] engine::Version workpiece(std::int32_t side, double spacing_mm, double noise_mm = 0.04);

}  // namespace fettle::trials
