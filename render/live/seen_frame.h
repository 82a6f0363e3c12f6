#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "render/live/live_picture.h"
#include "render/plan/plan.h"

namespace fettle::render {

/// What a frame showed, and where: the answers to questions about its pixels. They use the versions of its plan, in double
/// precision, whatever the device has of them.
///
/// Thread: any, one at a time.
struct SeenFrame {
  PicturePlan plan;
  std::vector<Rectangle> visible;           ///< of each panel [px]
  std::vector<std::array<Camera, 2>> eyes;  ///< of each panel; none unless in stereo
  StereoMode stereo = StereoMode::kOff;
  int eye_width = 0;  ///< of one eye's picture [px]

  /// As LivePicture::pick.
  [[nodiscard]] std::optional<Picked> pick(double x, double y) const;
  /// As LivePicture::pixelOf.
  [[nodiscard]] std::optional<std::pair<double, double>> pixelOf(int panel, const glm::dvec3& field_mm,
                                                                 Eye eye) const;
  /// As LivePicture::grip.
  [[nodiscard]] Grip grip(double x, double y) const;
};

}  // namespace fettle::render
