#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "engine/field/reader.h"
#include "render/live/live_picture.h"
#include "render/plan/plan.h"
#include "shaders/layout.h"

namespace fettle::render {

/// What a live frame shows and where: everything that does not depend on the heights.
///
/// Errors (kInput): input outside the ranges stated at FrameInput. Thread: any.
[[nodiscard]] engine::Result<PicturePlan> planFrame(const FrameInput& input, const Shown& shown,
                                                    const PictureSpans& spans);

/// A ray in field coordinates; its direction is not of unit length.
[[nodiscard]] Ray inField(const PanelPlan& panel, const Ray& ray);
/// What a hand takes hold of along a ray in the scene (LivePicture::grip), without its pixel.
[[nodiscard]] Grip gripOf(const PanelPlan& panel, const Ray& ray);
/// Position of the window in which the surface in the middle of the plot lies (Stereo::screen_distance).
[[nodiscard]] double windowAtMiddle(const PanelPlan& panel);
/// The lines of one kind, in the layout of the shaders.
[[nodiscard]] std::vector<gpu::Line> linesOf(const std::vector<OverlayLine>& lines, OverlayLine::Depth depth,
                                             const PanelPlan& panel);

/// The pieces of a brush ring, on the surface: 96 of them; those with an end over a hole or outside the field
/// are left out.
void appendRing(const engine::FieldReader& reader, const Overlays::Ring& ring, std::vector<OverlayLine>& out);

}  // namespace fettle::render
