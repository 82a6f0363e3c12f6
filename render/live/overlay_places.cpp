#include "render/live/overlay_places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/glm.hpp>

namespace fettle::render {
namespace {

// Beyond what shaders compute in single precision, in another order, near the middle of the scene.
constexpr double kRounding_px = 2.0;
// A coordinate is a sum of four products, of a matrix that is rounded as well.
constexpr double kRoundings = 8.0;

// A point in clip space, and the sums of what its x and y are the differences of: far from the middle of a scene seen closely they
// are large, and so is what rounding leaves of them.
struct Clip {
  glm::dvec4 at;
  glm::dvec2 sums;
};

Clip clipOf(const glm::dmat4& clip_from_scene, const glm::dvec3& point) {
  glm::dvec2 sums(glm::abs(glm::dvec2(clip_from_scene[3])));
  for (int i = 0; i < 3; ++i) sums += glm::abs(glm::dvec2(clip_from_scene[i]) * point[i]);
  return {clip_from_scene * glm::dvec4(point, 1.0), sums};
}

// What lies around points of a panel's picture [px].
class Around {
 public:
  explicit Around(const LivePanel& panel) : panel_(panel) {}

  // A point before the viewer; `reach` pixels around it.
  void add(const Clip& clip, double reach) {
    const glm::dvec2 half_plot(0.5 * panel_.plot.width, 0.5 * panel_.plot.height);
    const glm::dvec2 px =
        glm::dvec2(panel_.plot.x, panel_.plot.y) + half_plot * (glm::dvec2(clip.at) / clip.at.w + 1.0);
    const glm::dvec2 off =
        half_plot * clip.sums / clip.at.w * (kRoundings * std::numeric_limits<float>::epsilon());
    if (!std::isfinite(px.x) || !std::isfinite(px.y) || !std::isfinite(off.x) || !std::isfinite(off.y))
      return addAll();
    low_ = glm::min(low_, px - off - reach);
    high_ = glm::max(high_, px + off + reach);
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
  Clip a = clipOf(clip_from_scene, glm::dvec3(line.from)), b = clipOf(clip_from_scene, glm::dvec3(line.to));
  if (a.at.z < 0.0 && b.at.z < 0.0) return {};
  if (a.at.z < 0.0) a.at = glm::mix(b.at, a.at, b.at.z / (b.at.z - a.at.z));
  if (b.at.z < 0.0) b.at = glm::mix(a.at, b.at, a.at.z / (a.at.z - b.at.z));
  a.sums = b.sums = glm::max(a.sums, b.sums);  // where it is cut off lies between them
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
      const Clip clip = clipOf(clip_from_scene, corner);
      if (clip.at.w > 0.0)
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
