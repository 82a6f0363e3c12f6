#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "render/live/picture_rows.h"

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

/// A picture with validation on, shared by the cases of a program: making one takes longer than drawing.
inline LivePicture* sharedPicture() {
  static const engine::Result<std::unique_ptr<LivePicture>> picture = [] {
    LiveOptions options;
    options.validation = Validation::kOn;
    return LivePicture::create(options);
  }();
  if (!picture) ADD_FAILURE() << picture.error().line();
  return picture ? picture->get() : nullptr;
}

/// What a picture drawn once shows, and how.
struct Still {
  Shown shown;
  FrameInput input;
};

struct Shot {
  Image image;
  FrameStatistics stats;
};

/// Draws in parts of `part_side` pixels, and demands that the validation layers are silent.
inline Shot shoot(LivePicture& picture, const Still& still, int part_side = kPartSide) {
  Shot shot;
  shot.image.width = still.input.view.width;
  shot.image.height = still.input.view.height;
  const engine::Status updated = picture.update(still.shown);
  if (!updated) ADD_FAILURE() << updated.error().line();
  picture.refreshRanges();
  engine::JobControl job;
  const engine::Result<FrameStatistics> drawn = drawRows(
      picture, still.input,
      [&](const Image& rows) -> engine::Status {
        EXPECT_EQ(rows.width, still.input.view.width);
        shot.image.rgba.insert(shot.image.rgba.end(), rows.rgba.begin(), rows.rgba.end());
        return {};
      },
      job, part_side);
  if (!drawn) {
    ADD_FAILURE() << drawn.error().line();
    return shot;
  }
  for (const std::string& message : picture.validationMessages()) ADD_FAILURE() << message;
  EXPECT_EQ(job.done(), job.total());
  shot.stats = *drawn;
  return shot;
}

/// A small bare picture straight from above: north up, true heights, nothing around the surface.
inline Still mapOf(const engine::Version& field, int width, int height) {
  View view;
  view.width = width;
  view.height = height;
  view.azimuth_deg = 0.0;
  view.elevation_deg = 90.0;
  view.vertical_exaggeration = 1.0;
  Still still;
  still.shown.versions = {field};
  still.input = stillInput(view);
  still.input.decoration = Decoration::kNone;
  return still;
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
