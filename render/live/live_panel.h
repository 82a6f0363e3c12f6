#pragma once

#include <optional>
#include <vector>

#include "render/detail/patches.h"
#include "render/plan/plan.h"
#include "render/residency/live_texture.h"
#include "render/vulkan/pipelines.h"

namespace fettle::render {

/// One panel of a live frame.
struct LivePanel {
  Rectangle plot;     ///< where the camera's picture lies [px]
  Rectangle visible;  ///< the part of it that is drawn
  Rectangle
      tested;  ///< the part of that in which lines and a stylus are drawn that the surface hides: that has its depth
  Rectangle redraw;  ///< the part of `visible` that is drawn again; `choice` needs to cover only this
  gpu::PanelUniforms uniforms{};
  const PatchChoice* choice = nullptr;
  const LiveTexture* field = nullptr;
  const LiveTexture* original = nullptr;  ///< null for heights
  int shade_level = 0;                    ///< of LiveTexture
  int reach = 2;  ///< so many samples before its cell a colour may read, and one more after it
  SurfaceVariant variant;
  std::vector<std::uint32_t> pages;  ///< of pageTable; empty unless on demand
  std::vector<gpu::Line> in_scene, on_top;
  std::optional<gpu::Stylus> stylus{};
};

}  // namespace fettle::render
