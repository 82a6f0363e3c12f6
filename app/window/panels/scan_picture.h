#pragma once

#include <optional>

#include <imgui.h>

#include "app/files/scan_thumbnail.h"

namespace fettle::app {

/// Where the cursor is on a small picture.
struct PictureCursor {
  double column = 0.0, row = 0.0;  ///< of the whole scan, row 0 the lowest
  float height = 0.0F;             ///< NaN: hole
};

/// Draws a small picture of a scan at the cursor of the layout, as large as `size` allows in its own proportions, and takes
/// all of `size`. `step`: pixels of the picture from one that is drawn to the next, 1 or more. Nothing where the cursor is
/// elsewhere.
std::optional<PictureCursor> scanPicture(const ScanThumbnail& picture, ImVec2 size, int step = 1);

}  // namespace fettle::app
