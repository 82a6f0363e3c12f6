#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/detail/kept_trees.h"
#include "render/detail/patches.h"
#include "render/live/live_fields.h"
#include "render/live/live_frame.h"

namespace fettle::render {

/// What shows on the left or on the right of the split of a plot (FrameInput::split).
[[nodiscard]] Rectangle sideOf(const Rectangle& plot, double split, bool right);

/// The panels of one frame while it is made up: which patches are drawn of each field, how they are coloured,
/// and whose eyes see them.
///
/// Threading: as Context. References what it is made of.
class LivePanels {
 public:
  /// Chooses the patches, as if everything were on the device. Of panels that are as they were when `kept`
  /// was used last they are taken from there.
  LivePanels(const FrameInput& input, const PicturePlan& plan, LiveFields& fields, KeptTrees& kept);
  LivePanels(const LivePanels&) = delete;
  LivePanels& operator=(const LivePanels&) = delete;

  /// The pages that the patches need, for submission `frame`; only by need.
  [[nodiscard]] PageDemand demand(std::uint64_t frame);
  /// Takes coarser patches where pages are missing, and tells what will be drawn.
  void settle(FrameStatistics& stats);

  [[nodiscard]] std::vector<LivePanel>& panels() noexcept { return panels_; }
  [[nodiscard]] const std::vector<PatchQuestion>& questions() const noexcept { return questions_; }
  /// Of each panel in stereo; else none.
  [[nodiscard]] const std::vector<std::array<Camera, 2>>& eyes() const noexcept { return eyes_; }

 private:
  [[nodiscard]] PatchQuestion questionOf(std::size_t i, const FrameInput& input, const PanelPlan& p,
                                         std::int64_t vertices) const;
  [[nodiscard]] LivePanel panelOf(std::size_t i, const FrameInput& input, const PicturePlan& plan,
                                  const std::vector<OverlayLine>& lines) const;
  [[nodiscard]] Rectangle drawnOf(const Rectangle& plot) const;

  LiveFields& fields_;
  std::vector<PatchTree> trees_;
  std::vector<PatchQuestion> questions_;
  std::vector<PatchChoice> choices_;
  std::vector<LivePanel> panels_;
  std::vector<std::array<Camera, 2>> eyes_;
  std::optional<Rectangle> part_;  // FrameInput::part
};

}  // namespace fettle::render
