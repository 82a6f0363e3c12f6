#include "render/live/overlay_places.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/glm.hpp>

namespace fettle::render {
namespace {

// Beyond what shaders compute in single precision, in another order.
constexpr double kRounding_px = 2.0;

// What lies around points of a panel's picture [px].
class Around {
 public:
  explicit Around(const LivePanel& panel) : panel_(panel) {}

  // A point in clip space before the viewer; `reach` pixels around it.
  void add(const glm::dvec4& clip, double reach) {
    const glm::dvec2 place = 0.5 * glm::dvec2(clip) / clip.w + 0.5;
    const glm::dvec2 px(panel_.plot.x + place.x * panel_.plot.width,
                        panel_.plot.y + place.y * panel_.plot.height);
    if (!std::isfinite(px.x) || !std::isfinite(px.y)) return addAll();
    low_ = glm::min(low_, px - reach);
    high_ = glm::max(high_, px + reach);
  }
  void addAll() {
    low_ = glm::dvec2(-HUGE_VAL);
    high_ = glm::dvec2(HUGE_VAL);
  }

  [[nodiscard]] Rectangle visible() const {
    const Rectangle& v = panel_.visible;
    const glm::dvec2 first(v.x, v.y), end(v.x + v.width, v.y + v.height);
    const glm::ivec2 low(glm::floor(glm::clamp(low_, first, end)));
    const glm::ivec2 high(glm::ceil(glm::clamp(high_, first, end)));
    return {low.x, low.y, std::max(high.x - low.x, 0), std::max(high.y - low.y, 0)};
  }

 private:
  const LivePanel& panel_;
  glm::dvec2 low_{HUGE_VAL}, high_{-HUGE_VAL};
};

// As line.vert.
Rectangle placeOf(const LivePanel& panel, const gpu::Line& line) {
  const glm::dmat4 clip_from_scene(panel.uniforms.views[0].clip_from_scene);
  glm::dvec4 a = clip_from_scene * glm::dvec4(glm::dvec3(line.from), 1.0);
  glm::dvec4 b = clip_from_scene * glm::dvec4(glm::dvec3(line.to), 1.0);
  if (a.z < 0.0 && b.z < 0.0) return {};
  if (a.z < 0.0) a = glm::mix(b, a, b.z / (b.z - a.z));
  if (b.z < 0.0) b = glm::mix(a, b, a.z / (a.z - b.z));
  Around around(panel);
  // Along and across.
  const double reach = std::sqrt(2.0) * (0.5 * double{line.from.w} + 1.0) + kRounding_px;
  around.add(a, reach);
  around.add(b, reach);
  return around.visible();
}

// Boxes around what stylus.vert and stylus_shadow.vert draw.
Rectangle placeOf(const LivePanel& panel, const gpu::Stylus& stylus) {
  const glm::dmat4 clip_from_scene(panel.uniforms.views[0].clip_from_scene);
  const glm::dvec3 ball(stylus.ball), tail(stylus.tail), light(panel.uniforms.light);
  const double thick = std::max({double{stylus.tail.w}, double{stylus.ball.w}, double{stylus.shadow.w}});
  double wide = 2.0 * thick;
  std::vector<glm::dvec3> middles{glm::dvec3(stylus.point), ball, tail};
  if (stylus.shadow.x > 0.0F) {
    const double most = stylus.shadow.y, plate = stylus.point.w;
    const double down = std::clamp(ball.z - plate, 0.0, most);
    glm::dvec2 reach(most);
    if (light.z > 1e-3) {
      reach = glm::max(glm::dvec2(ball.z, tail.z) - plate, 0.0) / light.z;
      if (std::max(reach.x, reach.y) >= 0.999 * most) reach = glm::dvec2(most);
    }
    wide += 0.2 * std::max({down, reach.x, reach.y}) + 2.0 * stylus.shadow.z;
    middles.push_back(ball - reach.x * light);
    middles.push_back(tail - reach.y * light);
    middles.push_back(ball - glm::dvec3(0.0, 0.0, down));
  }
  Around around(panel);
  for (const glm::dvec3& middle : middles)
    for (int k = 0; k < 8; ++k) {
      const glm::dvec3 corner = middle + wide * (2.0 * glm::dvec3(k & 1, k >> 1 & 1, k >> 2) - 1.0);
      const glm::dvec4 clip = clip_from_scene * glm::dvec4(corner, 1.0);
      if (clip.w > 0.0)
        around.add(clip, kRounding_px);
      else
        around.addAll();  // beside or behind the viewer: anywhere
    }
  return around.visible();
}

}  // namespace

void addOverlays(std::span<const LivePanel> panels, Places& places) {
  for (const LivePanel& panel : panels) {
    if (empty(panel.visible)) continue;
    for (const gpu::Line& line : panel.in_scene) places.add(placeOf(panel, line));
    for (const gpu::Line& line : panel.on_top) places.add(placeOf(panel, line));
    if (panel.stylus) places.add(placeOf(panel, *panel.stylus));
  }
}

}  // namespace fettle::render
