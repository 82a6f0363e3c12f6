#pragma once

#include <functional>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "render/config.h"
#include "render/live/live_picture.h"

namespace fettle::render {

/// Receives the next rows of a picture, from the top on: as wide as the picture, any number of rows. An error
/// ends the drawing.
using RowSink = std::function<engine::Status(const Image& rows)>;

/// Settings for a still picture: shaded as in the window, four rays per pixel, every point of the surface
/// within a quarter of a pixel of its exact position.
[[nodiscard]] FrameInput stillInput(const View& view);

/// Draws what `picture` shows, with everything measured and uploaded that the view requests. Draws parts of
/// at most `part_side` pixels in each direction and submits their rows to `sink`, so that memory depends on
/// the width, and neither the picture nor the device's images limit its height. Parts join without a seam:
/// they are drawn by the same camera, and equal the picture drawn as one except for the rounding of single
/// precision (tests/render/live/parts_test.cpp has the bound). Progress counts parts. Returns sums over all
/// frames drawn; bound_px and limits are the worst of them.
/// Errors: those of draw() and of `sink`; kCancelled, between two frames.
[[nodiscard]] engine::Result<FrameStatistics> drawRows(LivePicture& picture, const FrameInput& input,
                                                       const RowSink& sink, engine::JobControl& job,
                                                       int part_side = kPartSide);

}  // namespace fettle::render
