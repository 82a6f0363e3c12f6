#pragma once

#include "app/window/parts.h"

namespace fettle::app {

/// Draws the picture of the frame if one is due: the document with its previews, suggested edges and stylus.
/// `sharp_motion`: full resolution while the view moves, regardless of the settings. Threading: main.
void drawField(Parts& parts, bool sharp_motion);
/// The same for the coarse picture of a scan that is being read.
void drawCoarse(Parts& parts, bool sharp_motion);

}  // namespace fettle::app
