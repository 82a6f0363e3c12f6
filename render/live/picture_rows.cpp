#include "render/live/picture_rows.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace fettle::render {
namespace {

// Copies columns `from` .. `from + columns - 1` of a part to column `to` of the band that it is part of.
void place(const Image& part, int from, int columns, Image& band, int to) {
  for (int y = 0; y < part.height; ++y)
    std::memcpy(band.rgba.data() + 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(band.width) +
                                        static_cast<std::size_t>(to)),
                part.rgba.data() + 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(part.width) +
                                        static_cast<std::size_t>(from)),
                4 * static_cast<std::size_t>(columns));
}

void add(FrameStatistics& all, const FrameStatistics& frame) {
  all.patches += frame.patches;
  all.vertices += frame.vertices;
  all.triangles += frame.triangles;
  all.bound_px = std::max(all.bound_px, frame.bound_px);
  all.within_budget = all.within_budget && frame.within_budget;
  all.upload.tiles += frame.upload.tiles;
  all.upload.bytes += frame.upload.bytes;
  all.upload.ms += frame.upload.ms;
  all.residency.pages_over_budget =
      std::max(all.residency.pages_over_budget, frame.residency.pages_over_budget);
  all.device_ms = std::max(0.0, all.device_ms) + frame.device_ms;
  all.range = frame.range;
  all.vertical_exaggeration = frame.vertical_exaggeration;
  all.pixels_per_mm = frame.pixels_per_mm;
  all.warnings = frame.warnings;
}

}  // namespace

FrameInput stillInput(const View& view) {
  FrameInput input;
  input.view = view;
  input.theme = Theme::kLight;
  input.error_px = kStillErrorPx;
  input.sharpness = Sharpness::kFine;
  input.form = kShownForm;
  // More than the rays of a part: error_px is what limits the vertices.
  input.vertex_budget = kMostFrameVertices;
  return input;
}

engine::Result<FrameStatistics> drawRows(LivePicture& picture, const FrameInput& input, const RowSink& sink,
                                         engine::JobControl& job, int part_side) {
  assert(part_side >= 2 && part_side % 2 == 0);
  const auto uploaded = picture.uploadAll(job);
  if (!uploaded) return tl::unexpected(uploaded.error());
  FrameStatistics all;
  all.upload = *uploaded;
  // Side by side, each part is drawn for both eyes, and appears once in each half.
  const bool halves = input.stereo.mode == StereoMode::kSideBySide;
  FrameInput part = input;
  part.pages = FrameInput::Pages::kAll;
  if (halves) part.view.width /= 2;
  const int width = part.view.width, height = part.view.height;
  const auto count = [&](int side) { return static_cast<std::uint64_t>((side + part_side - 1) / part_side); };
  job.begin("drawing", count(width) * count(height));
  Image band, drawn;
  for (int y = 0; y < height; y += part_side) {
    band.width = input.view.width;
    band.height = std::min(part_side, height - y);
    band.rgba.resize(std::size_t{4} * static_cast<std::size_t>(band.width) *
                     static_cast<std::size_t>(band.height));
    for (int x = 0; x < width; x += part_side) {
      const int columns = std::min(part_side, width - x);
      part.part = Rectangle{x, y, columns, band.height};
      if (job.cancelled()) return engine::cancelled();
      const engine::Result<FrameStatistics> frame = picture.draw(part, drawn);
      if (!frame) return tl::unexpected(frame.error());
      add(all, *frame);
      place(drawn, 0, columns, band, x);
      if (halves) place(drawn, columns, columns, band, width + x);
      job.advance();
    }
    // A picture of odd width shows the right eye's last column twice.
    if (halves && band.width % 2 != 0)
      for (int row = 0; row < band.height; ++row) {
        std::uint8_t* last =
            band.rgba.data() +
            std::size_t{4} * static_cast<std::size_t>(band.width) * static_cast<std::size_t>(row + 1) - 4;
        std::memcpy(last, last - 4, 4);
      }
    if (engine::Status status = sink(band); !status) return tl::unexpected(status.error());
  }
  return all;
}

}  // namespace fettle::render
