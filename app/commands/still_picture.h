#pragma once

#include <string>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "render/live/live_picture.h"

namespace fettle::app {

/// Draws `shown` into a PNG of any size, row by row, completely or not at all, or into a place in memory
/// (app/work/memory_places.h). Texts that did not fit are
/// reported on stderr, each line begun with `name` unless that is empty.
///
/// Errors: those of LivePicture::update, drawRows and PngWriter.
[[nodiscard]] engine::Result<render::FrameStatistics> drawPicture(
    render::LivePicture& picture, const render::Shown& shown, const render::FrameInput& input,
    const std::string& path, engine::JobControl& job, const std::string& name = {});

}  // namespace fettle::app
