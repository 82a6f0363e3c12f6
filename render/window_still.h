#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "engine/base/error.h"
#include "render/live_picture.h"
#include "render/window.h"

namespace fettle::render {

/// The pictures of `fettle render` in a window: all that Renderer can draw, with the calls of LivePicture.
/// Each frame is drawn to its end before draw() returns.
///
/// Threading: as Window. Uses of FrameInput: view, contours, marks_opacity, map, theme, decoration, titles,
/// range. Two versions lie side by side.
class WindowStill {
 public:
  explicit WindowStill(Window& window);
  ~WindowStill();
  WindowStill(const WindowStill&) = delete;
  WindowStill& operator=(const WindowStill&) = delete;

  [[nodiscard]] engine::Status update(const Shown& shown);
  [[nodiscard]] engine::Result<FrameStatistics> draw(const FrameInput& input);
  [[nodiscard]] std::optional<Picked> pick(double x, double y) const;
  [[nodiscard]] std::optional<std::pair<double, double>> pixelOf(int panel, const glm::dvec3& field_mm) const;
  void refreshRanges() {}

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fettle::render
