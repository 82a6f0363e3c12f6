#include "haptic/trials/hand_stroke.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/field/builder.h"
#include "haptic/contact/surface.h"

namespace fettle::trials {

std::vector<haptic::StrokeSample> handStroke(const engine::Version& field, const HandMotion& motion) {
  haptic::Surface surface(field.reader());
  const double width = surface.cellColumns() * surface.spacingX();
  const double height = surface.cellRows() * surface.spacingY();
  // The mean speed of a sine of amplitude a and rate w is 2 a w / pi.
  const double rate =
      motion.speed_mm_s * std::numbers::pi / (2.0 * 0.48 * std::max(width, height) * std::sqrt(2.0));
  std::vector<haptic::StrokeSample> strokes;
  strokes.reserve(static_cast<std::size_t>(motion.ticks));
  double ground = 0.0;
  for (std::int64_t i = 0; i < motion.ticks; ++i) {
    const double t = static_cast<double>(i) * motion.tick_s;
    // The golden ratio between the two rates keeps the curve from closing.
    glm::dvec3 tip{width * (0.5 + 0.48 * std::sin(rate * t)),
                   height * (0.5 + 0.48 * std::cos(rate * t * std::numbers::phi)), 0.0};
    const double tremor = 2.0 * std::numbers::pi * 9.0 * t;
    tip.x += motion.tremor_mm * std::sin(tremor);
    tip.y += motion.tremor_mm * std::cos(1.1 * tremor);
    haptic::CellIndex cell;
    haptic::Patch patch;
    if (surface.cellUnder(tip, cell) && surface.patch(cell, patch))
      ground = patch.heightAt((tip.x - patch.x0) / patch.sx, (tip.y - patch.y0) / patch.sy);
    const double press = 0.5 + 0.5 * std::sin(2.0 * std::numbers::pi * 1.7 * t);
    tip.z = ground + motion.lift_mm - press * (motion.press_mm + motion.lift_mm) +
            0.25 * motion.tremor_mm * std::sin(1.3 * tremor);
    strokes.push_back({t, tip, motion.tool});
  }
  return strokes;
}

engine::Version workpiece(std::int32_t side, double spacing_mm, double noise_mm) {
  engine::Grid grid;
  grid.width = grid.height = side;
  grid.spacing_x = grid.spacing_y = spacing_mm;
  std::vector<float> z(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  std::uint64_t state = 0x9e3779b97f4a7c15;
  for (std::int32_t r = 0; r < side; ++r)
    for (std::int32_t c = 0; c < side; ++c) {
      // Marsaglia 2003, xorshift64.
      state ^= state << 13;
      state ^= state >> 7;
      state ^= state << 17;
      const double noise = (static_cast<double>(state >> 11) * 0x1p-53 - 0.5) * noise_mm;
      const double x = c * spacing_mm;
      const double y = r * spacing_mm;
      // Flanks of slope 1 and less: an open-loop hand can follow these, a wall would stop it.
      const double step = std::clamp(8.0 * std::sin(x * 0.31) * std::sin(y * 0.23), -0.5, 0.5);
      const double rib = std::max(0.0, 0.4 - std::abs(std::fmod(x, 7.85) - 3.9));
      z[static_cast<std::size_t>(r) * side + c] =
          static_cast<float>(step + rib + 0.8 * std::sin(x * 0.4) * std::cos(y * 0.3) + noise);
    }
  return engine::makeField(grid, z);
}

}  // namespace fettle::trials
