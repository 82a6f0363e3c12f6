#pragma once

#include <string>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "render/live/live_picture.h"

namespace fettle::app {

/// Draws what `shown` holds into a PNG, row by row: whole or not at all, of any size. What had no room in it
/// goes to stderr, each line begun with `name` unless that is empty.
///
/// Errors: those of LivePicture::update, drawRows and PngWriter.
[[nodiscard]] engine::Result<render::FrameStatistics> drawPicture(
    render::LivePicture& picture, const render::Shown& shown, const render::FrameInput& input,
    const std::string& path, engine::JobControl& job, const std::string& name = {});

}  // namespace fettle::app
