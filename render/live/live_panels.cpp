#include "render/live/live_panels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/config.h"
#include "render/live/live_plan.h"
#include "render/plan/material.h"
#include "render/plan/placing.h"

namespace fettle::render {
namespace {

// Rays across a pixel.
double raysOf(Sharpness sharpness) {
  switch (sharpness) {
    case Sharpness::kQuarter:
      return 0.25;
    case Sharpness::kHalf:
      return 0.5;
    case Sharpness::kFine:
      return 2.0;
    case Sharpness::kFull:
    case Sharpness::kRest:
      break;
  }
  return 1.0;
}

bool holed(const engine::Version& v) {
  return v.reader().root().holed_children != 0;
}

// Colours of a deviation are read as numbers: shading may indicate the shape, but not darken them.
constexpr double kFormOfDeviation = 0.3;
constexpr float kMaterialOfDeviation = 0.5F;
constexpr double kDarkestLevel = 0.05;  // light that is brightened no more

// How far the outer samples of a footprint lie outside its cell [steps]: it reaches 1.25 rays to each side
// where a step is half a ray, with the smaller distance 1.5 where it is one.
glm::ivec2 footprintOf(const glm::dvec2& rays_per_step) {
  return {rays_per_step.x <= 0.5 ? 2 : 1, rays_per_step.y <= 0.5 ? 2 : 1};
}

// PanelUniforms::around of a level whose step is 2^shift samples; whole steps where cells are small.
glm::vec4 aroundOf(const PanelPlan& p, int shift, bool smooth) {
  const auto steps = [&](double px, const glm::dvec2& direction) {
    const glm::dvec2 d = px / p.camera.pixelsPerMm() * direction / std::ldexp(1.0, shift) / p.placing.spacing;
    return glm::clamp(smooth ? d : glm::round(d), 1.0, double{kMostAround});
  };
  const glm::dvec2 along = steps(kAroundPx, glm::dvec2(1.0));
  const glm::dvec2 between = steps(kAroundBetweenPx, glm::dvec2(std::sqrt(0.5)));
  return glm::vec4(glm::dvec4(along, between));
}

// PanelUniforms::seam.zw of a level whose step is 2^shift samples.
glm::vec2 contourSquareOf(const PanelPlan& p, int shift) {
  const glm::dvec2 steps = kContourPx / p.camera.pixelsPerMm() / std::ldexp(1.0, shift) / p.placing.spacing;
  return glm::clamp(glm::round(steps), 1.0, double{kMostAround});
}

// Of the view, also where a headset's eyes see it: the light stays where it is when the head turns.
glm::vec3 towardsLight(const FrameInput& input) {
  const double azimuth = input.light_azimuth_deg * std::numbers::pi / 180.0;
  const double up = std::sin(input.light_elevation_deg * std::numbers::pi / 180.0);
  const glm::dvec3 right = axesOf(input.view).right;
  const glm::dvec3 away{-right.y, right.x, 0.0};
  const glm::dvec3 level = std::cos(azimuth) * right + std::sin(azimuth) * away;
  return std::sqrt(std::max(0.0, 1.0 - up * up)) * level + glm::dvec3(0.0, 0.0, up);
}

// The light of a material and the directions of the picture, of a panel's camera.
void shadeAs(const FormShading& form, const Camera& camera, bool deviation, gpu::PanelUniforms& u) {
  const double values = deviation ? 1.0 : form.value_colours;
  gpu::Material look = rowOf(form.material).look;
  // What a mirror shows is not its own: it would not have the colours of values.
  look.shadow.w *= static_cast<float>(1.0 - values);
  const glm::dvec3 level = materialLight(look, {camera.right().z, camera.up().z, camera.toViewer().z});
  u.to_right = glm::vec4(glm::vec3(camera.right()), static_cast<float>(values));
  u.to_top = glm::vec4(glm::vec3(camera.up()), 0.0F);
  u.to_viewer = glm::vec4(glm::vec3(camera.toViewer()), deviation ? kMaterialOfDeviation : 1.0F);
  u.material = look;
  u.of_level = glm::vec4(glm::vec3(1.0 / glm::max(level, kDarkestLevel)), 0.0F);
}

}  // namespace

// Begins on an even column of the picture, so that no square of two by two fragments belongs to both sides.
Rectangle sideOf(const Rectangle& plot, double split, bool right) {
  const int wanted = static_cast<int>(std::lround(split * plot.width));
  const int at = std::min(wanted + ((plot.x + wanted) & 1), plot.width);
  Rectangle side = plot;
  side.width = at;
  if (right) side = {plot.x + at, plot.y, plot.width - at, plot.height};
  return side;
}

LivePanels::LivePanels(const FrameInput& input, const PicturePlan& plan, LiveFields& fields,
                       PatchTreeCache& trees, const std::array<Camera, 2>* head)
    : fields_(fields), part_(input.part) {
  const bool split = input.arrangement == Arrangement::kSplit && fields.count() >= 2;
  const std::size_t count = split ? 2 : plan.panels.size();
  const bool stereo = input.stereo.mode != StereoMode::kOff;
  const double window = !stereo                              ? 1.0
                        : input.stereo.screen_distance > 0.0 ? input.stereo.screen_distance
                                                             : windowAtMiddle(plan.panels.front());
  std::vector<OverlayLine> lines = input.overlays.lines;
  for (const Overlays::Ring& ring : input.overlays.rings)
    appendRing(fields.shown().versions.front().reader(), ring, lines);
  trees_.reserve(count);
  trees.keepOnly(count);
  choices_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const PanelPlan& p = plan.panels[i];
    if (stereo) eyes_.push_back(eyesOf(p.camera, input.stereo, window));
    if (head != nullptr) eyes_.push_back(*head);
    queries_.push_back(queryOf(i, input, p,
                               input.panel_vertices.empty()
                                   ? input.vertex_budget / static_cast<std::int64_t>(count)
                                   : input.panel_vertices[i]));
    std::vector<OverlayLine> own = lines;
    std::erase_if(
        own, [i](const OverlayLine& line) { return line.panel >= 0 && line.panel != static_cast<int>(i); });
    panels_.push_back(panelOf(i, input, plan, own));
    if (input.overlays.stylus) panels_.back().stylus = stylusIn(p, *input.overlays.stylus);
    panels_.back().visible = panels_.back().tested =
        drawnOf(split ? sideOf(p.plot, input.split, i > 0) : p.plot);
    queries_.back().shade_step = 1 << LiveTexture::shift(panels_.back().shade_level);
    queries_.back().shade_reach = panels_.back().reach + 1;
    trees_.push_back(empty(panels_.back().visible) ? PatchTree() : trees.tree(i, queries_.back(), p.field));
  }
}

PatchQuery LivePanels::queryOf(std::size_t i, const FrameInput& input, const PanelPlan& p,
                               std::int64_t vertices) const {
  PatchQuery q;
  q.measure = &fields_.measure(i);
  q.reader = p.field.reader();
  if (fields_.texture(i).pending() > 0)
    q.up_to_date = [&texture = fields_.texture(i)](glm::ivec2 first, glm::ivec2 last) {
      return !texture.anyPending(first / engine::kTileSide, last / engine::kTileSide);
    };
  q.placing = p.placing;
  q.camera = p.camera;
  if (!eyes_.empty()) {
    q.camera = eyes_[i][0];
    q.other_eye = eyes_[i][1];
  }
  if (part_) {
    const Rectangle around{part_->x - kAroundPartPx, part_->y - kAroundPartPx,
                           part_->width + 2 * kAroundPartPx, part_->height + 2 * kAroundPartPx};
    const Rectangle seen = cut(around, p.plot);
    if (!empty(seen)) q.parts.push_back(q.camera.part(seen));
    if (!empty(seen) && q.other_eye) q.parts.push_back(q.other_eye->part(seen));
  }
  q.mm_per_unit = p.mm_per_unit;
  q.reference = p.reference;
  q.lowest = p.lowest;
  q.highest = p.highest;
  q.floor_z = p.floor_z;
  q.error_px = input.error_px;
  q.vertex_budget = vertices;
  return q;
}

// What of a rectangle of the picture is drawn, in pixels of the target.
Rectangle LivePanels::drawnOf(const Rectangle& plot) const {
  if (!part_) return plot;
  Rectangle drawn = cut(plot, *part_);
  drawn.x -= part_->x;
  drawn.y -= part_->y;
  return drawn;
}

LivePanel LivePanels::panelOf(std::size_t i, const FrameInput& input, const PicturePlan& plan,
                              const std::vector<OverlayLine>& lines) const {
  const PanelPlan& p = plan.panels[i];
  const PatchQuery& q = queries_[i];
  const LiveTexture& original = fields_.original();
  LivePanel panel;
  const bool fine = input.sharpness == Sharpness::kFine;
  const double rays = raysOf(input.sharpness);
  // Colours come from samples about one ray or one pixel apart: in perspective the near part is larger than
  // the middle.
  const glm::dvec2 px = cellPixels(p.placing, p.camera) * (fine ? rays : 1.0);
  const double nearer = input.view.projection == Projection::kPerspective ? 2.0 : 1.0;
  while (panel.shade_level + 1 < LiveTexture::kLevels &&
         std::ldexp(std::max(px.x, px.y) * nearer, LiveTexture::shift(panel.shade_level + 1)) <= 1.0)
    ++panel.shade_level;
  const int shift = LiveTexture::shift(panel.shade_level);
  panel.plot = drawnOf(p.plot);
  panel.field = &fields_.texture(i);
  panel.original = original.version().empty() ? nullptr : &original;
  panel.uniforms = p.uniforms;
  gpu::PanelUniforms& u = panel.uniforms;
  if (shift > 0)
    u.shade = glm::ivec4(shift, 0, glm::max((p.placing.true_size - 1) / (1 << shift) + 1, glm::ivec2(2)));
  // Differences over about the width of a ray: finer ones would be noise below the size of a pixel.
  u.paging.w = std::max(
      1, static_cast<int>(std::lround(0.5 / std::max(1e-6, std::ldexp(std::min(px.x, px.y), shift)))));
  u.seam.x = static_cast<float>(kSeamRays / rays);
  if (fine) u.seam.y = static_cast<float>(u.seam.y / rays);
  const auto view = [&](const Camera& camera) {
    return part_ && !empty(panel.plot) ? viewOf(camera.part(cut(p.plot, *part_)), p.placing, panel.plot)
                                       : viewOf(camera, p.placing, p.plot);
  };
  u.views[0] = view(q.camera);
  if (q.other_eye) u.views[1] = view(*q.other_eye);
  u.ground = glm::vec4(plan.palette.ground, 1.0F);
  const Paging& paging = panel.field->paging();
  u.paging.x = paging.log2_columns;
  u.paging.y = paging.log2_rows;
  u.paging.z = static_cast<int>(paging.across);
  u.light = glm::vec4(towardsLight(input), u.light.w);
  const bool on_demand = fields_.onDemand();
  const bool smooth = std::max(px.x, px.y) > 1.5;
  glm::ivec2 footprint(0);
  if (input.form.filtered_normals && !smooth)
    footprint = footprintOf(std::ldexp(1.0, shift) * (fine ? px : rays * px));
  if (input.form.occlusion > 0.0 || input.form.cavity > 0.0) {
    u.around = aroundOf(p, shift, smooth);
    const double share = panel.original != nullptr ? kFormOfDeviation : 1.0;
    u.form = glm::vec4(share * glm::dvec4(input.form.occlusion, input.form.cavity, 0.0, 0.0));
    const float most = std::max(std::max(u.around.x, u.around.y), std::max(u.around.z, u.around.w));
    panel.reach = std::max(panel.reach, static_cast<int>(std::ceil(most)));
  }
  const bool material = input.form.material != Material::kNone;
  if (material) shadeAs(input.form, p.camera, panel.original != nullptr, u);
  if (input.contours == Contours::kShow) {
    const glm::vec2 square = contourSquareOf(p, shift);
    u.seam.z = square.x;
    u.seam.w = square.y;
    panel.reach = std::max(panel.reach, static_cast<int>(std::max(square.x, square.y)));
  }
  u.footprint = glm::ivec4(footprint, panel.reach, 0);
  panel.variant = {
      paging.paged(),
      fields_.shown().marks == MarksOverlay::kShow,
      panel.original != nullptr,
      input.contours == Contours::kShow,
      smooth,
      holed(p.field) || (panel.original != nullptr && holed(original.version())),
      !fine,
      on_demand,
      !on_demand && !paging.paged() && std::min(p.placing.true_size.x, p.placing.true_size.y) > 1 << shift,
      input.view.projection == Projection::kPerspective,
      input.form.filtered_normals && !smooth,
      input.form.occlusion > 0.0,
      input.form.cavity > 0.0,
      material};
  panel.in_scene = linesOf(lines, OverlayLine::Depth::kInScene, p);
  panel.on_top = linesOf(lines, OverlayLine::Depth::kOnTop, p);
  return panel;
}

PageDemand LivePanels::demand(std::uint64_t frame) {
  PageDemand demand;
  for (std::size_t i = 0; i < panels_.size(); ++i)
    demand.request(trees_[i], fields_.texture(i),
                   panels_[i].original != nullptr ? &fields_.original() : nullptr, panels_[i].shade_level,
                   std::max(panels_[i].uniforms.paging.w, panels_[i].reach), frame);
  return demand;
}

void LivePanels::finishChoice(FrameStatistics& stats) {
  for (std::size_t i = 0; i < panels_.size(); ++i) {
    bool pruned = false;
    if (fields_.onDemand()) {
      const PageSet& pages = *fields_.texture(i).pages();
      pruned = trees_[i].prune([&](const PatchLeaf& leaf) { return PageDemand::drawable(leaf, pages); });
      panels_[i].uniforms.pages = pageHead(pages.grid());
      panels_[i].pages =
          pageTable(pages, panels_[i].original != nullptr ? fields_.original().pages() : nullptr);
    }
    choices_[i] = trees_[i].list();
    panels_[i].choice = &choices_[i];
    stats.patches += static_cast<std::int64_t>(choices_[i].patches.size());
    stats.vertices += choices_[i].vertices();
    stats.triangles += choices_[i].triangles();
    stats.bound_px = std::max(stats.bound_px, choices_[i].bound_px);
    PanelDetail detail{choices_[i].bound_px, DetailLimit::kNone};
    if (detail.bound_px > queries_[i].error_px)
      detail.limit = !pruned                             ? DetailLimit::kVertices
                     : stats.residency.pages_waiting > 0 ? DetailLimit::kLoading
                                                         : DetailLimit::kMemory;
    stats.panels.push_back(detail);
    stats.within_budget = stats.within_budget && choices_[i].within_budget;
  }
}

}  // namespace fettle::render
