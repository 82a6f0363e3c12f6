#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "render/plan/picture.h"

namespace fettle::render {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

inline engine::Grid gridOf(int width, int height, double sx = 1.0, double sy = 1.0) {
  engine::Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = sx;
  grid.spacing_y = sy;
  return grid;
}

inline engine::Version fieldOf(const engine::Grid& grid, const std::function<double(int, int)>& height,
                               const std::function<bool(int, int)>& marked = {}) {
  std::vector<float> z;
  std::vector<std::uint8_t> marks;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      z.push_back(static_cast<float>(height(c, r)));
      if (marked) marks.push_back(marked(c, r) ? 1 : 0);
    }
  return engine::makeField(grid, z, marks);
}

/// A renderer with validation on, shared by the cases of a program: making one takes longer than a picture.
inline Renderer* sharedRenderer() {
  static const engine::Result<std::unique_ptr<Renderer>> renderer =
      Renderer::create({Validation::kOn, "", 0});
  if (!renderer) ADD_FAILURE() << renderer.error().line();
  return renderer ? renderer->get() : nullptr;
}

struct Shot {
  Image image;
  PictureReport report;
};

/// Draws, and demands that the validation layers are silent.
inline Shot shoot(Renderer& renderer, const PictureSpec& spec) {
  Shot shot;
  engine::JobControl job;
  engine::Result<PictureReport> report = renderer.render(spec, shot.image, job);
  if (!report) {
    ADD_FAILURE() << report.error().line();
    return shot;
  }
  for (const std::string& message : report->validation_messages) ADD_FAILURE() << message;
  shot.report = *report;
  return shot;
}

/// A small bare picture straight from above: north up, one ray a pixel, true heights, no furniture.
inline PictureSpec mapOf(const engine::Version& field, int width, int height) {
  PictureSpec spec;
  spec.field = field;
  spec.view.width = width;
  spec.view.height = height;
  spec.view.azimuth_deg = 0.0;
  spec.view.elevation_deg = 90.0;
  spec.view.vertical_exaggeration = 1.0;
  spec.samples_per_side = 1;
  spec.decoration = Decoration::kNone;
  return spec;
}

inline const std::uint8_t* pixel(const Image& image, int x, int y) {
  return image.rgba.data() + 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                  static_cast<std::size_t>(x));
}

/// Pixels that are not the ground's colour, taken from the corner of a bare picture.
inline int drawnPixels(const Image& image, const Image& empty_ground) {
  int n = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4)
    n += !std::equal(image.rgba.begin() + static_cast<std::ptrdiff_t>(i),
                     image.rgba.begin() + static_cast<std::ptrdiff_t>(i) + 3, empty_ground.rgba.begin());
  return n;
}

}  // namespace fettle::render
