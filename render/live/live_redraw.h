#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/field/version.h"
#include "render/detail/patches.h"
#include "render/live/live_frame.h"

namespace fettle::render {

/// What the layers of a LiveFrame show: a next frame that differs in some panels, or only in the fields, is
/// drawn in parts.
struct DrawnFrame {
  struct Panel {
    engine::Version field;
    gpu::PanelUniforms uniforms;
    SurfaceVariant variant;
    int shade_level = 0;
    Rectangle plot, visible;
    PatchChoice choice;
    std::vector<std::uint32_t> pages;  ///< on demand: loaded and evicted pages change what is drawn
  };
  std::vector<Panel> panels;
  std::vector<gpu::Quad> decorations;
  glm::vec3 ground{0.0F};
  engine::Version original;
  std::optional<engine::Version> accepted;
};

/// Whether a frame can be drawn over the one before: both have the same layout, and some panel shows a state
/// of the same field in the same way.
[[nodiscard]] bool canContinue(const DrawnFrame& before, const DrawnFrame& now);

/// Whether two frames differ at most in how finely they show the same: in the choice of patches, and in the pages they are drawn
/// from.
[[nodiscard]] bool sameButDetail(const DrawnFrame& before, const DrawnFrame& now);
/// Whether a frame shows what one with fewer pixels does, edits and pages aside: as long as only some of its rows are drawn the
/// others may show that one.
[[nodiscard]] bool sameButPixels(const DrawnFrame& fewer, const DrawnFrame& now);
/// Whether two panels of such frames do not differ in that either.
[[nodiscard]] bool sameDetail(const DrawnFrame::Panel& a, const DrawnFrame::Panel& b);

/// Whether a frame shows what the one before does.
[[nodiscard]] bool showTheSame(const DrawnFrame& before, const DrawnFrame& now);

/// Whether pages that the frame reads are on the device: where some are not, their samples are drawn from coarser ones.
enum class Pages { kThere, kWaitedFor };

/// Sets the part of each panel that is drawn again - the difference by damageOf, or the whole panel where
/// more changed than samples and patches - and clips the panels' choices to it: to the returned ones, which
/// must outlive the panels.
[[nodiscard]] std::vector<PatchChoice> cutToDamage(const DrawnFrame& before, const DrawnFrame& now,
                                                   std::span<const PatchQuery> queries, Pages pages,
                                                   std::vector<LivePanel>& panels);

/// Rows of the picture in bands, drawn a frame each.
struct Bands {
  int first = 0, end = 0;  ///< rows of all of them; `first` is even
  int all = 1;
  int next = 0, left = all;  ///< 0 <= next < all, 1 <= left
  /// Where a band begins: on an even row, so that no square of two by two fragments belongs to two of them.
  [[nodiscard]] int row(int band) const noexcept {
    return band == all ? end : (first + (end - first) * band / all) & ~1;
  }
};
struct CutBands {
  std::vector<PatchChoice> parts;
  int bands = 1;  ///< so many are drawn: `next` and those after it
};
/// Sets LivePanel::redraw to the rows of the next band of each panel's part of the picture, and clips the panels' choices to it, as
/// cutToDamage. Where a surface is so steep that one band takes half of all its vertices, and those are many, a frame of one band takes
/// as long as one of several: then kRoundsOfSteep frames draw all bands.
[[nodiscard]] CutBands cutToBands(const Bands& bands, std::span<const PatchQuery> queries,
                                  std::vector<LivePanel>& panels);

}  // namespace fettle::render
