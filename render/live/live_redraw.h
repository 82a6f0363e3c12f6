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

/// What the layers of a LiveFrame show: another frame that differs in some panels, or in the fields alone, is
/// drawn in parts.
struct DrawnFrame {
  struct Panel {
    engine::Version field;
    gpu::PanelUniforms uniforms;
    SurfaceVariant variant;
    int shade_level = 0;
    Rectangle plot, visible;
    PatchChoice choice;
    std::vector<std::uint32_t> pages;  ///< by need: pages that come and go change what is drawn
  };
  std::vector<Panel> panels;
  std::vector<gpu::Quad> furniture;
  glm::vec3 ground{0.0F};
  engine::Version original;
  std::optional<engine::Version> accepted;
};

/// Whether a frame can go on from the one before: both lie alike on the picture, and some panel of it shows a
/// state of the same field in the same way.
[[nodiscard]] bool goesOn(const DrawnFrame& before, const DrawnFrame& now);

/// Sets what of each panel is to be drawn anew - where damageOf says that it differs, or all of it where more
/// changed than samples and patches - and cuts the panels' choices down to that: to those returned, which
/// have to outlive the panels.
[[nodiscard]] std::vector<PatchChoice> cutToDamage(const DrawnFrame& before, const DrawnFrame& now,
                                                   std::span<const PatchQuestion> questions,
                                                   std::vector<LivePanel>& panels);

}  // namespace fettle::render
