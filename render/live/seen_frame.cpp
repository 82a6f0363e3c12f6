#include "render/live/seen_frame.h"

#include <cstddef>

#include "render/detail/pick.h"
#include "render/live/live_plan.h"

namespace fettle::render {
namespace {

// A place in the picture of one eye, where each has half of the frame; else in the frame itself.
struct SeenPixel {
  glm::dvec2 at;
  Eye eye = Eye::kLeft;
};

SeenPixel seenPixel(const SeenFrame& seen, double x, double y) {
  if (seen.stereo == StereoMode::kSideBySide && x >= seen.eye_width)
    return {{x - seen.eye_width, y}, Eye::kRight};
  return {{x, y}};
}

Ray rayAt(const SeenFrame& seen, std::size_t panel, const SeenPixel& pixel) {
  const Camera& camera = seen.stereo == StereoMode::kSideBySide
                             ? seen.eyes[panel][static_cast<std::size_t>(pixel.eye)]
                             : seen.plan.panels[panel].camera;
  return camera.rayAt(pixel.at);
}

// Empty beside all plots.
std::optional<std::size_t> panelAt(const SeenFrame& seen, const glm::dvec2& at) {
  for (std::size_t i = 0; i < seen.visible.size(); ++i) {
    const Rectangle& r = seen.visible[i];
    if (at.x >= r.x && at.y >= r.y && at.x < r.x + r.width && at.y < r.y + r.height) return i;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Picked> SeenFrame::pick(double x, double y) const {
  const SeenPixel pixel = seenPixel(*this, x, y);
  const std::optional<std::size_t> panel = panelAt(*this, pixel.at);
  if (!panel) return std::nullopt;
  const PanelPlan& p = plan.panels[*panel];
  const Ray ray = inField(p, rayAt(*this, *panel, pixel));
  const auto hit = meetSurface(p.field.reader(), ray.from, ray.along);
  if (!hit) return std::nullopt;
  return Picked{static_cast<int>(*panel), hit->position_mm, hit->column, hit->row};
}

std::optional<std::pair<double, double>> SeenFrame::pixelOf(int panel, const glm::dvec3& field_mm,
                                                            Eye eye) const {
  if (panel < 0 || static_cast<std::size_t>(panel) >= visible.size()) return std::nullopt;
  const auto i = static_cast<std::size_t>(panel);
  const PanelPlan& p = plan.panels[i];
  const Camera& camera = stereo != StereoMode::kOff ? eyes[i][static_cast<std::size_t>(eye)] : p.camera;
  const glm::dvec2 at = camera.pixelOf(inScene(p, field_mm));
  const bool right = stereo == StereoMode::kSideBySide && eye == Eye::kRight;
  return std::pair{at.x + (right ? eye_width : 0), at.y};
}

Grip SeenFrame::grip(double x, double y) const {
  const SeenPixel pixel = seenPixel(*this, x, y);
  // Beside all plots, at the colour bar, as beside the field of the first.
  const std::size_t panel = panelAt(*this, pixel.at).value_or(0);
  const PanelPlan& p = plan.panels[panel];
  Grip grip = gripOf(p, rayAt(*this, panel, pixel));
  grip.pixel = p.camera.pixelOf(grip.point);
  return grip;
}

}  // namespace fettle::render
