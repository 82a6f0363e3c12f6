#include "app/window/stylus_overlay.h"

#include <algorithm>

#include <glm/geometric.hpp>

#include "app/window/scene_edits.h"

namespace fettle::app {
namespace {

constexpr std::size_t kForces = 240;
constexpr double kLargestForce_px = 60.0;  // the arrow of the largest force

}  // namespace

bool StylusOverlay::moved(const haptic::LoopState& state, double mm_per_pixel) const {
  return glm::length(state.endpoint_mm - state_.endpoint_mm) > mm_per_pixel ||
         state.contact != state_.contact;
}

void StylusOverlay::append(const LoopClient& client, const haptic::LoopState& state, double mm_per_pixel,
                           render::Overlays& overlays) {
  const haptic::Scene& scene = client.scene();
  const engine::Grid& grid = client.field().grid();
  render::StylusState tip;
  tip.endpoint_mm = state.endpoint_mm;
  tip.proxy_mm = state.proxy_mm;
  tip.force_n = state.force_n;
  tip.contact = state.contact;
  if (scene.tip == haptic::TipShape::kSphere) tip.tip_radius_mm = scene.tip_radius_mm;
  render::appendStylus(tip, kLargestForce_px * mm_per_pixel / scene.force_limit_n, overlays.lines);
  render::Overlays::Ring ring;
  ring.x_mm = state.contact ? state.proxy_mm.x : state.endpoint_mm.x;
  ring.y_mm = state.contact ? state.proxy_mm.y : state.endpoint_mm.y;
  ring.radius_mm = std::max(brushRadius(client), 0.5) * std::max(grid.spacingXMm(), grid.spacingYMm());
  ring.colour =
      haptic::isMarkTool(client.tool()) ? glm::vec3{1.0F, 0.55F, 0.0F} : glm::vec3{1.0F, 1.0F, 1.0F};
  overlays.rings.push_back(ring);
}

void StylusOverlay::drawn() {
  forces_.push_back(static_cast<float>(glm::length(state_.force_n)));
  if (forces_.size() > kForces) forces_.erase(forces_.begin());
}

}  // namespace fettle::app
