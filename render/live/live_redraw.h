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

/// Sets LivePanel::redraw to the rows [first, last) of each panel's part of the picture, and clips the panels' choices to them, as
/// cutToDamage.
[[nodiscard]] std::vector<PatchChoice> cutToRows(int first, int last, std::span<const PatchQuery> queries,
                                                 std::vector<LivePanel>& panels);

}  // namespace fettle::render
