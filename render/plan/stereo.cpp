#include "render/plan/stereo.h"

#include <fmt/format.h>

namespace fettle::render {

engine::Status check(const Stereo& stereo) {
  const auto in = [](double x, double low, double high) { return x >= low && x <= high; };
  if (!(stereo.eye_separation > 0.0 && stereo.eye_separation <= 0.25))
    return engine::inputError(fmt::format("eyes that are {} of their distance apart", stereo.eye_separation),
                              "stereo", "give more than 0 and at most 0.25");
  if (stereo.eye_separation_mm != 0.0 && !in(stereo.eye_separation_mm, 1.0, 200.0))
    return engine::inputError(fmt::format("pictures {} mm apart on the screen", stereo.eye_separation_mm),
                              "stereo", "give 1 to 200, or 0");
  if (!in(stereo.mm_per_pixel, 0.01, 10.0))
    return engine::inputError(fmt::format("a screen of {} mm a pixel", stereo.mm_per_pixel), "stereo",
                              "give 0.01 to 10");
  if (stereo.screen_distance != 0.0 && !in(stereo.screen_distance, 0.1, 10.0))
    return engine::inputError(fmt::format("a window at {} of the distance", stereo.screen_distance), "stereo",
                              "give 0.1 to 10, or 0");
  return {};
}

std::array<Camera, 2> eyesOf(const Camera& middle, const Stereo& stereo, double screen_distance) {
  double half = 0.5 * stereo.eye_separation;
  if (stereo.eye_separation_mm > 0.0) {
    // An eye `aside` to the right moves a point infinitely far behind a window at distance S by pixels_at(S)
    // * aside to the right, pixels_at being the pixels per millimetre at that distance.
    const double px = 0.5 * stereo.eye_separation_mm / stereo.mm_per_pixel;
    half = px / middle.asidePixels(screen_distance);
  }
  return {middle.aside(-half, screen_distance), middle.aside(half, screen_distance)};
}

double parallaxOf(const std::array<Camera, 2>& eyes, const glm::dvec3& point) noexcept {
  return eyes[1].pixelOf(point).x - eyes[0].pixelOf(point).x;
}

}  // namespace fettle::render
