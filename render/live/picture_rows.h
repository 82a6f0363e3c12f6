#pragma once

#include <functional>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "render/config.h"
#include "render/live/live_picture.h"

namespace fettle::render {

/// Takes the next rows of a picture, from the top on: as wide as the picture and as high as it likes. An error
/// ends the drawing.
using RowSink = std::function<engine::Status(const Image& rows)>;

/// How a picture is drawn that is looked at for longer than it takes to make: four rays a pixel, every point
/// of the surface within a quarter of a pixel of where it belongs.
[[nodiscard]] FrameInput stillInput(const View& view);

/// Draws what `picture` shows, at rest: with everything measured and uploaded that the view asks for. In parts
/// of at most `part_side` pixels each way, one after the other, and hands their rows on, so that memory
/// follows the width and neither the picture nor the device's images limit its height. Parts join without a
/// seam: they are drawn by the same camera, and equal the picture drawn as one but for the rounding of single
/// precision (tests/render/live/parts_test.cpp has the bound). Progress counts parts. What is returned are
/// sums over all frames drawn; bound_px and limits are the worst of them.
/// Errors: those of draw() and of `sink`; kCancelled, between two frames.
[[nodiscard]] engine::Result<FrameStatistics> drawRows(LivePicture& picture, const FrameInput& input,
                                                       const RowSink& sink, engine::JobControl& job,
                                                       int part_side = kPartSide);

}  // namespace fettle::render
