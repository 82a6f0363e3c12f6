// Frames of a live picture, validation layers on, and what they show.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <tuple>
#include <vector>

#include "tests/render/support/fields.h"

namespace fettle::render {

inline double hash01(int c, int r) {
  std::uint32_t h = static_cast<std::uint32_t>(c) * 2654435761U ^ static_cast<std::uint32_t>(r) * 2246822519U;
  h ^= h >> 15U;
  h *= 2246822519U;
  return (h >> 8U) / 16777216.0;
}

/// Heights of a machined part in little [mm]: slopes, a boss and a groove with steep walls, a dome, some
/// noise.
struct MachinedPart {
  double spacing_mm, slope, dome_x_mm;
  double operator()(int c, int r) const {
    const double x = c * spacing_mm, y = r * spacing_mm;
    double z = slope * x + 0.01 * hash01(c, r);
    if (std::hypot(x - 20, y - 30) < 9) z += 5;
    if (y > 8 && y < 12) z -= 3;
    const double dome = std::hypot(x - dome_x_mm, y - 25);
    if (dome < 12) z += std::sqrt(144 - dome * dome) * 0.5;
    return z;
  }
};

/// One that the device holds as a whole.
inline constexpr MachinedPart kPart{0.1, 0.02, 45.0};
inline engine::Version partField(int w = 640, int h = 480) {
  return fieldOf(gridOf(w, h, 0.1, 0.1), kPart);
}

/// One of which it holds a part, given little memory.
inline constexpr MachinedPart kLargePart{0.05, 0.03, 50.0};
inline constexpr int kWidth = 1500, kHeight = 1100;
inline engine::Version largeField() {
  return fieldOf(gridOf(kWidth, kHeight, 0.05, 0.05), kLargePart,
                 [](int c, int r) { return (c + 2 * r) % 190 < 5; });
}
/// The same with holes in places, also on the last column and row.
inline engine::Version holedField() {
  return fieldOf(gridOf(kWidth, kHeight, 0.05, 0.05), [](int c, int r) {
    const bool gap = std::hypot(c - 700.0, r - 500.0) < 40 || (c > 1400 && r % 300 < 60) ||
                     (r > 1080 && c % 400 < 33) || hash01(c, r) > 0.9995;
    return gap ? double{kNan} : kLargePart(c, r);
  });
}
/// Large for a picture, in little memory: a wave, and a step of its own in every tile.
inline engine::Version wideField(double lift) {
  return fieldOf(gridOf(2600, 2000, 0.05, 0.05), [&](int c, int r) {
    return lift + std::sin(0.01 * c) * std::cos(0.013 * r) + 0.05 * (((c >> 6) + (r >> 6)) & 3);
  });
}

/// 0: as LiveOptions has it.
struct Limits {
  std::int64_t budget = 0;
  std::int64_t bytes_per_frame = kUploadBytesPerFrame;
  int max_side = 0;
};
inline std::unique_ptr<LivePicture> makePicture(const Limits& limits = {}) {
  LiveOptions options;
  options.validation = Validation::kOn;
  options.memory_budget_bytes = limits.budget;
  options.upload_bytes_per_frame = limits.bytes_per_frame;
  options.max_image_side = limits.max_side;
  auto picture = LivePicture::create(options);
  if (!picture) ADD_FAILURE() << picture.error().line();
  return picture ? *std::move(picture) : nullptr;
}

inline FrameInput bare(int width = 480, int height = 320) {
  FrameInput input;
  input.view.width = width;
  input.view.height = height;
  input.decoration = Decoration::kNone;
  return input;
}
/// A bare picture of a place of the large field.
inline FrameInput bareAt(double zoom, double x = 0.5, double y = 0.5) {
  FrameInput input = bare(360, 240);
  input.view.zoom = zoom;
  input.view.centre_x = x;
  input.view.centre_y = y;
  input.view.vertical_exaggeration = 1.0;
  input.range = ValueRange{-3, 9};
  return input;
}
/// The surface at full resolution.
inline FrameInput full(FrameInput input) {
  input.error_px = 1e-9;
  input.vertex_budget = 1 << 24;
  return input;
}
/// From above, oblique, low, near; parallel and in perspective.
inline std::vector<FrameInput> views() {
  std::vector<FrameInput> all;
  for (const auto& [azimuth, elevation, zoom] :
       {std::tuple{0.0, 90.0, 1.0}, {315.0, 45.0, 1.0}, {20.0, 25.0, 1.0}, {100.0, 60.0, 2.5}}) {
    FrameInput input = bare();
    input.view.azimuth_deg = azimuth;
    input.view.elevation_deg = elevation;
    input.view.zoom = zoom;
    all.push_back(input);
    input.view.projection = Projection::kPerspective;
    all.push_back(input);
  }
  return all;
}

/// Draws one frame.
inline Shot shoot(LivePicture& picture, const FrameInput& input) {
  Shot frame;
  const auto stats = picture.draw(input, frame.image);
  if (!stats) {
    ADD_FAILURE() << stats.error().line();
    return frame;
  }
  for (const std::string& message : picture.validationMessages()) ADD_FAILURE() << message;
  frame.stats = *stats;
  return frame;
}
/// Frames until nothing is left to be moved or measured and no page is on its way; the last of them.
inline Shot drawComplete(LivePicture& picture, const FrameInput& input, int* frames = nullptr) {
  for (int n = 1; n < 1000; ++n) {
    Shot frame = shoot(picture, input);
    if (frames != nullptr) *frames = n;
    if (frame.stats.upload.pending_tiles == 0 && frame.stats.residency.pages_loaded == 0) return frame;
  }
  ADD_FAILURE() << "never at rest";
  return {};
}

/// Pixels that differ.
inline std::size_t differing(const Image& a, const Image& b) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4)
    n += !std::equal(a.rgba.begin() + static_cast<std::ptrdiff_t>(i),
                     a.rgba.begin() + static_cast<std::ptrdiff_t>(i) + 4,
                     b.rgba.begin() + static_cast<std::ptrdiff_t>(i));
  return n;
}
/// Pixels of `a` that no pixel of `b` within `radius` equals within `codes` in every channel.
inline int unmatched(const Image& a, const Image& b, int radius, int codes) {
  int off = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      bool found = false;
      for (int v = std::max(0, y - radius); v <= std::min(a.height - 1, y + radius) && !found; ++v)
        for (int u = std::max(0, x - radius); u <= std::min(a.width - 1, x + radius) && !found; ++u) {
          int worst = 0;
          for (int k = 0; k < 3; ++k)
            worst = std::max(worst, std::abs(pixel(a, x, y)[k] - pixel(b, u, v)[k]));
          found = worst <= codes;
        }
      off += !found;
    }
  return off;
}

}  // namespace fettle::render
