#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/detail/patch_tree_cache.h"
#include "render/detail/patches.h"
#include "render/live/live_fields.h"
#include "render/live/live_frame.h"

namespace fettle::render {

/// The part of a plot on the left or on the right of the split (FrameInput::split).
[[nodiscard]] Rectangle sideOf(const Rectangle& plot, double split, bool right);

/// The panels of one frame while it is prepared: the patches drawn of each field, their colours, and the
/// cameras of the eyes.
///
/// Threading: as Context. References what it is made of.
class LivePanels {
 public:
  /// Chooses the patches as if everything were on the device. Panels unchanged since `cache` was used last
  /// reuse its trees.
  /// `head`: cameras of a headset's eyes (FrameInput::eyes), else null.
  LivePanels(const FrameInput& input, const PicturePlan& plan, LiveFields& fields, PatchTreeCache& trees,
             const std::array<Camera, 2>* head = nullptr);
  LivePanels& operator=(LivePanels&&) = delete;

  /// The pages that the patches need, for submission `frame`; only on demand.
  [[nodiscard]] PageDemand demand(std::uint64_t frame);
  /// Uses coarser patches where pages are missing, and reports what will be drawn.
  void finishChoice(FrameStatistics& stats);

  [[nodiscard]] std::vector<LivePanel>& panels() noexcept { return panels_; }
  [[nodiscard]] const std::vector<PatchQuery>& queries() const noexcept { return queries_; }
  /// Of each panel in stereo; else none.
  [[nodiscard]] const std::vector<std::array<Camera, 2>>& eyes() const noexcept { return eyes_; }

 private:
  [[nodiscard]] PatchQuery queryOf(std::size_t i, const FrameInput& input, const PanelPlan& p,
                                   std::int64_t vertices) const;
  [[nodiscard]] LivePanel panelOf(std::size_t i, const FrameInput& input, const PicturePlan& plan,
                                  const std::vector<OverlayLine>& lines) const;
  [[nodiscard]] Rectangle drawnOf(const Rectangle& plot) const;

  LiveFields& fields_;
  std::vector<PatchTree> trees_;
  std::vector<PatchQuery> queries_;
  std::vector<PatchChoice> choices_;
  std::vector<LivePanel> panels_;
  std::vector<std::array<Camera, 2>> eyes_;
  std::optional<Rectangle> part_;  // FrameInput::part
};

}  // namespace fettle::render
