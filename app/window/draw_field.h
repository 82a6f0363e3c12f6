#pragma once

#include "app/window/parts.h"
#include "app/xr/headset_exchange.h"

namespace fettle::app {

/// What the settings would leave open for this run of the program.
struct DrawOptions {
  bool sharp_motion = false;   ///< never Sharpness::kHalf while the view moves
  bool steady = false;         ///< whatever time it takes (WindowPicture::adapt)
  bool smooth_at_rest = true;  ///< false: never Sharpness::kRest
};

/// Draws the picture of the frame if one is due: the document with its previews, suggested edges and stylus. Threading:
/// main.
void drawField(Parts& parts, const DrawOptions& options);
/// What a headset shows of the open document: the field without previews, in the colours of the window, and the stylus.
[[nodiscard]] HeadsetPicture headsetPicture(Parts& parts, const DrawOptions& options);
/// How the tip of the hand looks in it.
[[nodiscard]] TipLook tipLookOf(const Parts& parts);
/// The same for the coarse picture of a scan that is being read.
void drawCoarse(Parts& parts, const DrawOptions& options);

}  // namespace fettle::app
