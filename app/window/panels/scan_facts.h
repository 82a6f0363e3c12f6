#pragma once

#include <string>

#include "app/files/scan_thumbnail.h"
#include "app/window/panels/scan_picture.h"

namespace fettle::app {

/// "4096 x 4096 samples"; empty where the file does not tell before it is read.
[[nodiscard]] std::string sizeText(const ScanThumbnail& picture);
/// "0.02 x 0.02 mm": how far samples lie apart along rows and columns, in the unit in which the window has lengths across a field.
[[nodiscard]] std::string spacingText(const engine::Grid& grid);
/// "81.9 x 81.9 mm, 0.02 x 0.02 mm apart", in the same unit.
[[nodiscard]] std::string extentText(const ScanThumbnail& picture);
/// "heights -0.31 to 12.4 mm", "about" where not all was read; empty without heights.
[[nodiscard]] std::string heightsText(const ScanThumbnail& picture);
/// "x 12.3  y 4.5 mm  z 7.8 um", "hole" for the height of a hole.
[[nodiscard]] std::string cursorText(const ScanThumbnail& picture, const PictureCursor& cursor);

}  // namespace fettle::app
