#pragma once

#include <climits>
#include <optional>
#include <vector>

#include "render/config.h"
#include "render/live/live_frame.h"
#include "render/live/live_panels.h"
#include "render/live/live_picture.h"
#include "render/live/live_redraw.h"

namespace fettle::render {

/// A frame that the layers of a LiveFrame show in part: the bands that are drawn, and elsewhere the same less finely.
struct BandedFrame {
  DrawnFrame goal;
  std::vector<bool> differs;  ///< of each panel: from what was shown before
  int all = kDetailBands;     ///< bands
  int next = 0;               ///< of them; after the last one the first, where `goal` has changed meanwhile
  int left = all;             ///< that differ from `goal`
  /// Row from which on there are only colours of a frame with fewer pixels, with the lines that the surface hides, and no depth [px].
  int depth_end = INT_MAX;
};

/// What the layers of a LiveFrame show, and so how little of the next frame is drawn over it.
///
/// Threading: one thread at a time, the drawing one.
class ShownLayers {
 public:
  struct Reused {
    std::vector<PatchChoice> parts;     ///< what the panels' choices point to
    std::optional<BandedFrame> banded;  ///< once the frame is submitted
    LiveFrame::Redraw redraw = LiveFrame::Redraw::kAll;
  };

  /// Sets what is drawn of each panel (LivePanel::redraw, its choice, tested), over what the layers show already where they can be
  /// used, and of `stats` what tells it. The panels' choices point to what is returned. What the layers show is unknown from here
  /// until submitted().
  [[nodiscard]] Reused reuse(FrameInput::Redraw redraw, const DrawnFrame& current, LivePanels& chosen,
                             FrameStatistics& stats);

  enum class Holds {
    kNothing,      ///< that a next frame could be drawn over
    kFewerPixels,  ///< all of the frame at half or a quarter of the resolution
    kEveryPixel,
  };
  /// The frame is on its way to the device; `reused` is what reuse() returned for it.
  void submitted(Reused reused, DrawnFrame current, Holds holds);

 private:
  static std::vector<PatchChoice> nextBand(BandedFrame& next, LivePanels& chosen);

  // One of the three at most.
  std::optional<DrawnFrame> drawn_;
  std::optional<BandedFrame> banded_;
  std::optional<DrawnFrame> with_less_;  // of its colours alone, at half or a quarter of the resolution
};

}  // namespace fettle::render
