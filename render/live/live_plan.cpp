#include "render/live/live_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

#include "render/config.h"
#include "render/detail/pick.h"

namespace fettle::render {

namespace {

// The panels as layOut places them in a row, or in two rows of two or three.
render::Layout arranged(const FrameInput& input, int versions) {
  const bool titled =
      std::any_of(input.titles.begin(), input.titles.end(), [](const auto& t) { return !t.empty(); });
  const Titles titles = !titled ? Titles::kNone : input.titles_in_margin ? Titles::kInMargin : Titles::kAbove;
  if (input.arrangement == Arrangement::kSplit && versions >= 2) {
    render::Layout layout = layOut(input.view, input.decoration, 1, titles, input.decoration_scale);
    layout.plots.push_back(layout.plots.front());
    return layout;
  }
  if (versions < 4) return layOut(input.view, input.decoration, versions, titles, input.decoration_scale);
  render::Layout layout =
      layOut(input.view, input.decoration, (versions + 1) / 2, titles, input.decoration_scale);
  const std::vector<Rectangle> columns = layout.plots;
  const int gap = static_cast<int>(std::lround((titled ? 40 : 16) * layout.scale));
  layout.plots.clear();
  for (int row = 0; row < 2; ++row)
    for (Rectangle plot : columns) {
      const int height = (plot.height - gap) / 2;
      plot.y += row * (height + gap);
      plot.height = height;
      layout.plots.push_back(plot);
    }
  return layout;
}

}  // namespace

Ray inField(const PanelPlan& p, const Ray& ray) {
  const double unit = p.field.grid().height_unit.mm;
  const auto field = [&](const glm::dvec3& s) {
    return glm::dvec3(glm::dvec2(s) - p.placing.first, (s.z / p.mm_per_unit + p.reference) * unit);
  };
  const glm::dvec3 from = field(ray.from);
  return {from, field(ray.from + ray.along) - from};
}

namespace {

// Where a ray enters a box [0 .. infinity), and through which of its faces: 0 x, 1 y, 2 z; nothing where it does not.
struct Entry {
  double along = 0.0;
  int face = 2;
};
std::optional<Entry> entryOf(const Box& box, const Ray& ray) {
  Entry entry{-1.0, 2};
  double leave = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    if (ray.along[k] == 0.0) {
      if (ray.from[k] < box.low[k] || ray.from[k] > box.high[k]) return std::nullopt;
      continue;
    }
    const double a = (box.low[k] - ray.from[k]) / ray.along[k],
                 b = (box.high[k] - ray.from[k]) / ray.along[k];
    if (std::min(a, b) > entry.along) entry = {std::min(a, b), k};
    leave = std::min(leave, std::max(a, b));
  }
  if (!(entry.along >= 0.0 && entry.along <= leave)) return std::nullopt;
  return entry;
}

}  // namespace

Grip gripOf(const PanelPlan& p, const Ray& ray) {
  Grip grip;
  grip.framing = p.framing;
  const Box& block = p.framing.drawn;
  const auto take = [&](const glm::dvec3& point, bool on_surface) {
    grip.point = point;
    grip.on_surface = on_surface;
    return grip;
  };
  const auto entry = entryOf(block, ray);
  if (entry && entry->face != 2) {
    // The side of the block reaches from its floor to the surface at the rim.
    const glm::dvec3 at = ray.from + entry->along * ray.along;
    const glm::dvec2 field = glm::dvec2(at) - p.placing.first;
    const glm::dvec2 last = p.placing.spacing * glm::dvec2(p.placing.true_size - 1);
    // Rounding must not put the rim outside.
    const auto rim =
        surfaceHeight(p.field.reader(), std::clamp(field.x, 0.0, last.x), std::clamp(field.y, 0.0, last.y));
    if (rim && inScene(p, {field, *rim}).z >= at.z) return take(at, true);
  }
  const Ray through = inField(p, ray);
  if (const auto hit = meetSurface(p.field.reader(), through.from, through.along))
    return take(inScene(p, hit->position_mm), true);
  // Over a hole: the plane at half the relief, unless it is seen too much from the side to be where the hole is.
  constexpr double kLeastSlope = 0.1;
  if (entry && ray.along.z < -kLeastSlope) {
    const glm::dvec3 at = ray.from - ray.from.z / ray.along.z * ray.along;
    const bool inside =
        at.x >= block.low.x && at.x <= block.high.x && at.y >= block.low.y && at.y <= block.high.y;
    if (inside) return take(at, false);
  }
  // As far away as the middle of the block, or as the middle of the picture where that is too near or behind.
  const Camera& camera = p.camera;
  constexpr double kNearest = 0.1;  // of the distance of what is shown
  const glm::dvec3 middle = p.framing.middle();
  const bool in_front = camera.windowOf(middle) > kNearest;
  const glm::dvec3& depth_of = in_front ? middle : camera.target();
  const double along =
      glm::dot(camera.toViewer(), depth_of - ray.from) / glm::dot(camera.toViewer(), ray.along);
  return take(ray.from + along * ray.along, false);
}

double windowAtMiddle(const PanelPlan& p) {
  const glm::dvec2 middle(p.plot.x + 0.5 * p.plot.width, p.plot.y + 0.5 * p.plot.height);
  const Ray ray = inField(p, p.camera.rayAt(middle));
  const auto hit = meetSurface(p.field.reader(), ray.from, ray.along);
  if (!hit) return 1.0;
  glm::dvec3 at = inScene(p, hit->position_mm);
  // Heights are drawn clipped.
  at.z = std::clamp(at.z, p.floor_z, p.cut_z);
  return std::clamp(p.camera.windowOf(at), 0.1, 10.0);
}

engine::Result<PicturePlan> planFrame(const FrameInput& input, const Shown& shown,
                                      const PictureSpans& spans) {
  const bool finite = std::isfinite(input.light_azimuth_deg) && input.light_elevation_deg >= 5.0 &&
                      input.light_elevation_deg <= 90.0;
  if (!(input.error_px > 0.0) || input.vertex_budget < kFewestFrameVertices ||
      input.vertex_budget > kMostFrameVertices || !finite || !(input.split >= 0.0 && input.split <= 1.0))
    return engine::inputError("the error, the budget, the split or the light is out of range", "picture",
                              "see FrameInput");
  const auto share = [](double s) { return s >= 0.0 && s <= 1.0; };
  if (!share(input.form.occlusion) || !share(input.form.cavity) || !share(input.form.value_colours))
    return engine::inputError(
        "the strength of the occlusion or of the cavity, or the share of colours on a material, is out of "
        "range",
        "picture", "give 0 to 1");
  const std::size_t panels = input.arrangement == Arrangement::kSplit
                                 ? std::min<std::size_t>(2, shown.versions.size())
                                 : shown.versions.size();
  const auto allowed = [](std::int64_t vertices) { return vertices >= 1 && vertices <= kMostFrameVertices; };
  if (!input.panel_vertices.empty() &&
      (input.panel_vertices.size() != panels ||
       !std::all_of(input.panel_vertices.begin(), input.panel_vertices.end(), allowed)))
    return engine::inputError("the vertices of the panels are out of range, or not one number a panel",
                              "picture", "see FrameInput");
  PictureSpec spec;
  spec.view = input.view;
  spec.deviation_from = shown.original;
  spec.difference = shown.difference;
  spec.range = input.range;
  spec.marks = shown.marks;
  spec.marks_look = input.marks_look;
  spec.marks_opacity = input.marks_opacity;
  spec.colouring = input.colouring;
  spec.contours = input.contours;
  spec.decoration = input.decoration;
  spec.theme = input.theme;
  engine::Result<PicturePlan> plan =
      planPicture(spec, shown.versions, spans, arranged(input, static_cast<int>(shown.versions.size())));
  if (plan) {
    plan->decorations.titles = input.titles;
    plan->decorations.lines = input.overlays.meanings;
    plan->decorations.colours = input.form.material == Material::kNone || input.form.value_colours > 0.0 ||
                                shown.original.has_value();
    const auto anyMark = [](const engine::Version& v) { return v.reader().root().marked_children != 0; };
    // The plan counts suggested marks as marks.
    if (shown.accepted)
      plan->decorations.marks = shown.marks == MarksOverlay::kShow &&
                                (anyMark(*shown.accepted) ||
                                 std::any_of(shown.versions.begin() + 1, shown.versions.end(), anyMark));
    plan->decorations.suggested =
        shown.marks == MarksOverlay::kShow && shown.accepted && !(*shown.accepted == shown.versions.front());
  }
  return plan;
}

std::vector<gpu::Line> linesOf(const std::vector<OverlayLine>& lines, OverlayLine::Depth depth,
                               const PanelPlan& panel) {
  std::vector<gpu::Line> out;
  const double per_mm = panel.mm_per_unit / panel.field.grid().height_unit.mm;
  const double zero_mm = panel.reference * panel.field.grid().height_unit.mm;
  // Slightly towards the viewer, so that a line on the surface is not hidden by it. The surface that is drawn lies within a pixel or so of
  // the field on the screen: in height that is the more, the steeper one looks down on it, and from above it says nothing.
  const glm::dvec3& to_viewer = panel.camera.toViewer();
  const double least = depth == OverlayLine::Depth::kInScene ? 1.5 / panel.camera.pixelsPerMm() : 0.0;
  const double flat = glm::length(glm::dvec2(to_viewer));
  const double more = to_viewer.z > flat ? (flat > 0.0 ? least * (to_viewer.z / flat - 1.0)
                                                       : std::numeric_limits<double>::infinity())
                                         : 0.0;
  const auto scene = [&](const glm::dvec3& p) {
    const double z = (p.z - zero_mm) * per_mm;
    // Not above what is drawn at all, where the camera sees nothing.
    const double lift = more > 0.0 && least > 0.0
                            ? std::min(least + more, std::max(least, (panel.cut_z - z) / to_viewer.z))
                            : least;
    return glm::dvec3(panel.placing.first + glm::dvec2(p), z) + lift * to_viewer;
  };
  for (const OverlayLine& l : lines)
    if (l.depth == depth)
      out.push_back({glm::vec4(glm::vec3(scene(l.from_mm)), l.width_px),
                     glm::vec4(glm::vec3(scene(l.to_mm)), 0.0F), glm::vec4(l.colour, l.opacity)});
  return out;
}

// Linear light; distinguishable on viridis, grey and blue - red also by colour-blind users (Okabe and Ito
// 2008).
constexpr glm::vec3 kEndpoint{0.90F, 0.35F, 0.0F};
constexpr glm::vec3 kProxy{1.0F, 1.0F, 1.0F};
constexpr glm::vec3 kTip{0.85F, 0.85F, 0.85F};
constexpr glm::vec3 kForce{0.88F, 0.78F, 0.05F};

void appendStylus(const StylusState& state, double mm_per_newton, std::vector<OverlayLine>& out) {
  if (state.discs) out.push_back({state.endpoint_mm, state.endpoint_mm, kEndpoint, 1.0F, 9.0F});
  if (!state.contact) return;
  out.push_back({state.endpoint_mm, state.proxy_mm, kTip, 0.8F, 1.5F});
  if (state.discs) out.push_back({state.proxy_mm, state.proxy_mm, kProxy, 1.0F, 9.0F});
  if (state.discs && state.tip_radius_mm > 0.0) {
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
  if (!state.arrow || !(newton > 0.0) || !std::isfinite(newton)) return;
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
