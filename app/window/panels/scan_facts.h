#pragma once

#include <string>

#include "app/files/scan_thumbnail.h"
#include "app/window/panels/scan_picture.h"

namespace fettle::app {

/// "4096 x 4096 samples"; empty where the file does not tell before it is read.
[[nodiscard]] std::string sizeText(const ScanThumbnail& picture);
/// "81.9 x 81.9 mm, 20 x 20 um apart", in units that read well.
[[nodiscard]] std::string extentText(const ScanThumbnail& picture);
/// "heights -0.31 to 12.4 mm", "about" where not all was read; empty without heights.
[[nodiscard]] std::string heightsText(const ScanThumbnail& picture);
/// "x 12.3  y 4.5 mm  z 7.8 um", "hole" for the height of a hole.
[[nodiscard]] std::string cursorText(const ScanThumbnail& picture, const PictureCursor& cursor);

}  // namespace fettle::app
