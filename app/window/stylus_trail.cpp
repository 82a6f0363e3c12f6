#include "app/window/stylus_trail.h"

#include <algorithm>
#include <cstddef>

#include <glm/geometric.hpp>

namespace fettle::app {
namespace {

const glm::vec3 kTrailColour{0.95F, 0.45F, 0.05F};
constexpr float kNewest_px = 4.0F, kOldest_px = 0.5F;

}  // namespace

void StylusTrail::append(const glm::dvec3& tip_mm, double mm_per_pixel, Clock::time_point now,
                         render::Overlays& overlays) {
  if (!places_.empty() && glm::length(tip_mm - places_.back().at_mm) < mm_per_pixel)
    places_.back().when = now;
  else
    places_.push_back({tip_mm, now});
  while (places_.size() > 1 && now - places_.front().when > kLasts) places_.pop_front();
  for (std::size_t i = 0; i + 1 < places_.size(); ++i) {
    const std::chrono::duration<float> age = now - places_[i].when;
    const float left = std::max(0.0F, 1.0F - age / std::chrono::duration<float>(kLasts));
    render::OverlayLine piece;
    piece.depth = render::OverlayLine::Depth::kInScene;
    piece.from_mm = places_[i].at_mm;
    piece.to_mm = places_[i + 1].at_mm;
    piece.colour = kTrailColour;
    // Thinner, not fainter: the round ends of pieces that let light through would be seen as beads.
    piece.width_px = kOldest_px + (kNewest_px - kOldest_px) * left;
    overlays.lines.push_back(piece);
  }
}

}  // namespace fettle::app
