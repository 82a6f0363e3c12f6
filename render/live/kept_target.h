#pragma once

#include <optional>
#include <span>
#include <vector>

#include "render/live/live_panel.h"
#include "render/plan/places.h"
#include "render/vulkan/live_target.h"
#include "render/vulkan/memory.h"

namespace fettle::render {

/// What is copied from a base to a target: all of it, or these places.
struct BaseCopy {
  const GpuImage& base;
  std::vector<Rectangle> places;  ///< disjoint, within the target
  bool over_before = false;       ///< the target holds the frame before
};

/// The target that holds the last frame, so that the next one writes only what differs: what was drawn again of the base, and the
/// places of overlays, before and now.
///
/// Threading: as LiveFrame.
class KeptTarget {
 public:
  /// What of the base goes to the target for these panels, which is the last frame from now on. `changed`: places of the base since
  /// the frame before; nothing: all of it.
  [[nodiscard]] BaseCopy copyTo(const LiveTarget& target, const GpuImage& base,
                                std::span<const LivePanel> panels, std::optional<Places> changed);
  /// Something else is drawn to the target.
  void forget() noexcept { held_.reset(); }

 private:
  struct Held {
    std::uint64_t kept = 0;
    vk::Image image;
    vk::Extent2D extent;
    const GpuImage* base = nullptr;
    std::vector<Rectangle> overlays;
  };
  std::optional<Held> held_;
};

}  // namespace fettle::render
