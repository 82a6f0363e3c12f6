#pragma once

#include <span>

#include "render/live/live_panel.h"
#include "render/vulkan/memory.h"

namespace fettle::render {

/// Draws the stylus of each panel over a finished picture of the surface, against its depth, which it leaves as it is:
/// its shadow, faintly what the surface hides of it, then what it does not.
class StylusPass {
 public:
  /// `view_mask`: of the pipelines' views, 0: there is one.
  StylusPass(Pipelines& pipelines, std::uint32_t view_mask) : pipelines_(pipelines), view_mask_(view_mask) {}

  /// Whether there is one to be seen: without it a frame has no such pass.
  [[nodiscard]] static bool neededBy(std::span<const LivePanel> panels);

  /// What it is drawn over: images of one size.
  struct Over {
    const GpuImage& depth;
    vk::ImageView colour;
    vk::Image image;  // of `colour`
    float scale = 1.0F;
  };
  /// After everything that writes the depth, outside of a rendering. `sets`: one for each panel.
  void record(const vk::raii::CommandBuffer& commands, std::span<const LivePanel> panels,
              std::span<const vk::DescriptorSet> sets, const Over& to);

 private:
  Pipelines& pipelines_;
  std::uint32_t view_mask_;
};

}  // namespace fettle::render
