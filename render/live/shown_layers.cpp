#include "render/live/shown_layers.h"

#include <algorithm>
#include <utility>

namespace fettle::render {
namespace {

// Share of the visible plots that is drawn again, 0 .. 1.
double redrawnShare(const std::vector<LivePanel>& panels) {
  double plots_px = 0.0, redrawn_px = 0.0;
  for (const LivePanel& panel : panels) {
    plots_px += static_cast<double>(panel.visible.width) * panel.visible.height;
    redrawn_px += static_cast<double>(panel.redraw.width) * panel.redraw.height;
  }
  return redrawn_px / std::max(1.0, plots_px);
}

}  // namespace

ShownLayers::Reused ShownLayers::reuse(FrameInput::Redraw redraw, const DrawnFrame& current,
                                       LivePanels& chosen, FrameStatistics& stats) {
  const std::optional<DrawnFrame> whole = std::exchange(drawn_, std::nullopt);
  const std::optional<DrawnFrame> with_less = std::exchange(with_less_, std::nullopt);
  std::optional<BandedFrame> begun = std::exchange(banded_, std::nullopt);
  const DrawnFrame* const before = begun ? &begun->goal : whole ? &*whole : nullptr;
  const bool in_bands = redraw == FrameInput::Redraw::kInBands;
  // Layers that show a frame in part are of use for its other bands alone.
  if (redraw == FrameInput::Redraw::kAll || (begun && !in_bands)) return {};
  std::vector<LivePanel>& panels = chosen.panels();
  Reused reused;
  reused.redraw = LiveFrame::Redraw::kParts;
  if (in_bands && with_less && sameButPixels(*with_less, current)) {
    reused.banded = BandedFrame{.goal = current,
                                .differs = std::vector<bool>(panels.size(), true),
                                .all = kSharpBands,
                                .depth_end = 0};
    reused.parts = nextBand(*reused.banded, chosen);
    reused.redraw = LiveFrame::Redraw::kFirstPartOver;
    stats.band = true;
  } else if (const bool same = before != nullptr && showTheSame(*before, current);
             before != nullptr && in_bands && sameButDetail(*before, current) && (begun || !same)) {
    std::vector<bool> differs = begun ? begun->differs : std::vector<bool>(panels.size());
    for (std::size_t i = 0; i < panels.size(); ++i)
      differs[i] = differs[i] || !sameDetail(before->panels[i], current.panels[i]);
    reused.banded = begun ? std::move(begun) : BandedFrame{};
    BandedFrame& next = *reused.banded;
    if (next.differs != differs) next.next = 0;
    if (!same) next.left = next.all;
    next.goal = current;
    next.differs = std::move(differs);
    reused.parts = nextBand(next, chosen);
    stats.band = true;
  } else if (before != nullptr && canContinue(*before, current) && !(begun && begun->depth_end < INT_MAX)) {
    reused.parts = cutToDamage(*before, current, chosen.queries(),
                               stats.residency.pages_waiting > 0 ? Pages::kWaitedFor : Pages::kThere, panels);
    reused.banded = std::move(begun);
    if (reused.banded) reused.banded->goal = current;
  } else {
    // Also an edit where rows lack their depth: a stroke may go on for long, and would not be over what is below it.
    return {};
  }
  if (reused.banded && reused.banded->left == 0) reused.banded.reset();
  // Below that such lines are in the colours already, and there is no depth that could hide them.
  if (reused.banded && reused.banded->depth_end < INT_MAX)
    for (LivePanel& panel : panels)
      panel.tested = cut(panel.visible, {panel.visible.x, 0, panel.visible.width, reused.banded->depth_end});
  stats.bands_left = reused.banded ? reused.banded->left : 0;
  stats.continued = true;
  stats.redrawn = redrawnShare(panels);
  return reused;
}

std::vector<PatchChoice> ShownLayers::nextBand(BandedFrame& next, LivePanels& chosen) {
  std::vector<LivePanel>& panels = chosen.panels();
  Bands bands{.first = INT_MAX, .end = 0, .all = next.all, .next = next.next, .left = next.left};
  for (std::size_t i = 0; i < panels.size(); ++i) {
    if (!next.differs[i]) continue;
    bands.first = std::min(bands.first, panels[i].visible.y & ~1);
    bands.end = std::max(bands.end, panels[i].visible.y + panels[i].visible.height);
  }
  CutBands drawn = cutToBands(bands, chosen.queries(), panels);
  for (std::size_t i = 0; i < panels.size(); ++i)
    if (!next.differs[i]) panels[i].redraw = {};
  const int behind = bands.row(next.next + drawn.bands);
  // The first round goes from the top to the bottom.
  if (next.depth_end < INT_MAX)
    next.depth_end = behind == bands.end ? INT_MAX : std::max(next.depth_end, behind);
  next.next = (next.next + drawn.bands) % next.all;
  next.left -= drawn.bands;
  return std::move(drawn.parts);
}

void ShownLayers::submitted(Reused reused, DrawnFrame current, Holds holds) {
  banded_ = std::move(reused.banded);
  if (holds == Holds::kEveryPixel && !banded_)
    drawn_ = std::move(current);
  else if (holds == Holds::kFewerPixels)
    with_less_ = std::move(current);
}

}  // namespace fettle::render
