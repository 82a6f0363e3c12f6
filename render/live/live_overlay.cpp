#include "render/live/live_overlay.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "render/detail/pick.h"

namespace fettle::render {
namespace {

// Linear light; distinguishable on viridis, grey and blue - red also by colour-blind users (Okabe and Ito
// 2008).
constexpr glm::vec3 kEndpoint{0.90F, 0.35F, 0.0F};
constexpr glm::vec3 kProxy{1.0F, 1.0F, 1.0F};
constexpr glm::vec3 kTip{0.85F, 0.85F, 0.85F};
constexpr glm::vec3 kForce{0.88F, 0.78F, 0.05F};

}  // namespace

void appendStylus(const StylusState& state, double mm_per_newton, std::vector<OverlayLine>& out) {
  out.push_back({state.endpoint_mm, state.endpoint_mm, kEndpoint, 1.0F, 9.0F});
  if (!state.contact) return;
  out.push_back({state.endpoint_mm, state.proxy_mm, kTip, 0.8F, 1.5F});
  out.push_back({state.proxy_mm, state.proxy_mm, kProxy, 1.0F, 9.0F});
  if (state.tip_radius_mm > 0.0) {
    // The ball's outline as three circles, one about each axis.
    constexpr int kPieces = 48;
    for (int axis = 0; axis < 3; ++axis)
      for (int i = 0; i < kPieces; ++i) {
        const auto at = [&](int k) {
          const double a = 2.0 * std::numbers::pi * k / kPieces;
          glm::dvec3 p = state.proxy_mm;
          p[(axis + 1) % 3] += state.tip_radius_mm * std::cos(a);
          p[(axis + 2) % 3] += state.tip_radius_mm * std::sin(a);
          return p;
        };
        out.push_back({at(i), at(i + 1), kProxy, 0.7F, 1.2F});
      }
  }
  const double newton = glm::length(state.force_n);
  if (!(newton > 0.0) || !std::isfinite(newton)) return;
  const glm::dvec3 tip = state.proxy_mm + mm_per_newton * state.force_n;
  out.push_back({state.proxy_mm, tip, kForce, 1.0F, 3.0F});
  // Head: four strokes back from the tip, a fifth of the arrow long.
  const glm::dvec3 along = state.force_n / newton;
  const glm::dvec3 other = std::abs(along.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 across = glm::normalize(glm::cross(along, other)), third = glm::cross(along, across);
  const double back = 0.2 * mm_per_newton * newton;
  for (const glm::dvec3& side : {across, -across, third, -third})
    out.push_back({tip, tip - back * along + 0.5 * back * side, kForce, 1.0F, 3.0F});
}

void appendRing(const engine::FieldReader& reader, const Overlays::Ring& ring,
                std::vector<OverlayLine>& out) {
  constexpr int kPieces = 96;
  std::optional<glm::dvec3> before;
  for (int i = 0; i <= kPieces; ++i) {
    const double a = 2.0 * std::numbers::pi * i / kPieces;
    const double x = ring.x_mm + ring.radius_mm * std::cos(a), y = ring.y_mm + ring.radius_mm * std::sin(a);
    const std::optional<double> z = surfaceHeight(reader, x, y);
    std::optional<glm::dvec3> here;
    if (z) here = glm::dvec3(x, y, *z);
    if (before && here) out.push_back({*before, *here, ring.colour, 1.0F, ring.width_px});
    before = here;
  }
}

}  // namespace fettle::render
