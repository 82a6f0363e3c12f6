#pragma once

#include "app/window/parts.h"

namespace fettle::app {

/// Draws the frame's picture where one is due: of the document with its previews, suggested edges and stylus.
/// `sharp_motion`: every pixel while the view moves, whatever the settings say. Threading: main.
void drawField(Parts& parts, bool sharp_motion);
/// The same of the coarse picture of a scan that is being read.
void drawCoarse(Parts& parts, bool sharp_motion);

}  // namespace fettle::app
