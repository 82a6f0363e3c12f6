#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "render/live/live_picture.h"
#include "render/plan/plan.h"
#include "shaders/layout.h"

namespace fettle::render {

/// What a live frame shows and where, from what does not change with the heights.
///
/// Errors (kInput): what FrameInput says about ranges. Thread: any.
[[nodiscard]] engine::Result<PicturePlan> planFrame(const FrameInput& input, const Shown& shown,
                                                    const PictureSpans& spans);

/// A line of sight in field coordinates: where it comes from and where it goes, not of unit length.
[[nodiscard]] Ray inField(const PanelPlan& panel, const Ray& ray);
/// A point of the field in scene coordinates.
[[nodiscard]] glm::dvec3 inScene(const PanelPlan& panel, const glm::dvec3& field_mm);
/// Where the window stands that the surface in the middle of the plot lies on (Stereo::screen_distance).
[[nodiscard]] double windowAtMiddle(const PanelPlan& panel);
/// Those lines of one kind, as the shaders take them.
[[nodiscard]] std::vector<gpu::Line> linesOf(const std::vector<OverlayLine>& lines, OverlayLine::Depth depth,
                                             const PanelPlan& panel);

}  // namespace fettle::render
