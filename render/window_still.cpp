#include "render/window_still.h"

#include <array>
#include <chrono>
#include <cmath>

#include "render/frame.h"
#include "render/plan.h"

namespace fettle::render {

struct WindowStill::Impl {
  Window& window;
  Glyphs glyphs;
  Frame frame;
  std::array<FieldTexture, 3> textures;
  Shown shown;
  PicturePlan plan;
  UploadCount uploaded;
  double upload_ms = 0.0;

  Impl(Window& w, Glyphs g) : window(w), glyphs(std::move(g)), frame(w.context()) {}
};

WindowStill::WindowStill(Window& window) {
  auto glyphs = Glyphs::create();
  // The font is part of the program: without it nothing of this room works.
  if (!glyphs) std::abort();
  impl_ = std::make_unique<Impl>(window, std::move(*glyphs));
}
WindowStill::~WindowStill() = default;

engine::Status WindowStill::update(const Shown& shown) {
  Impl& s = *impl_;
  s.shown = shown;
  engine::JobControl job;
  const auto start = std::chrono::steady_clock::now();
  const auto marks =
      shown.marks == MarksOverlay::kShow ? FieldTexture::Marks::kBring : FieldTexture::Marks::kLeave;
  const auto bring = [&](FieldTexture& texture, const engine::Version& version, FieldTexture::Marks what) {
    const auto count = texture.update(s.window.context(), version, what,
                                      s.window.context().limits().maxImageDimension2D, job);
    if (count) s.uploaded.tiles += count->tiles, s.uploaded.bytes += count->bytes;
    return count.has_value();
  };
  bool all = true;
  for (std::size_t i = 0; i < std::min<std::size_t>(shown.versions.size(), 2); ++i)
    all = bring(s.textures[i], shown.versions[i], marks) && all;
  if (shown.original) all = bring(s.textures[2], *shown.original, FieldTexture::Marks::kLeave) && all;
  s.upload_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  if (!all) return engine::failure("the device cannot hold the field", "picture", "");
  return {};
}

engine::Result<FrameStatistics> WindowStill::draw(const FrameInput& input) try {
  Impl& s = *impl_;
  FrameStatistics figures;
  PictureSpec spec;
  const Rectangle& area = s.window.pictureArea();
  spec.view = input.view;
  spec.view.width = area.width;
  spec.view.height = area.height;
  spec.field = s.shown.versions.front();
  if (s.shown.versions.size() > 1) spec.compare = s.shown.versions[1];
  spec.deviation_from = s.shown.original;
  spec.range = input.range;
  spec.marks = s.shown.marks;
  spec.marks_opacity = input.marks_opacity;
  spec.map = input.map;
  spec.contours = input.contours;
  spec.decoration = input.decoration;
  spec.theme = input.theme;
  if (!input.titles.empty()) spec.title_left = input.titles.front();
  if (input.titles.size() > 1) spec.title_right = input.titles[1];
  spec.samples_per_side = 1;
  spec.cell_px = 4.0;
  auto plan = planPicture(spec);
  if (!plan) return tl::unexpected(plan.error());
  s.plan = std::move(*plan);
  std::vector<PanelDraw> panels;
  for (std::size_t i = 0; i < s.plan.panels.size(); ++i)
    panels.push_back({&s.plan.panels[i], &s.textures[i], spec.deviation_from ? &s.textures[2] : nullptr});
  if (s.glyphs.used() > Glyphs::kSide / 2) s.glyphs.clear();
  std::vector<std::string> warnings;
  const auto furniture =
      furnish(s.plan.layout, spec.view, s.plan.furniture, s.plan.palette, s.glyphs, warnings);
  engine::JobControl job;
  const FrameOptions options{1, spec.marks, spec.contours, 1e9};
  const auto ms = s.frame.draw(s.plan, panels, furniture, options, s.glyphs, s.window.pictureImage(), job);
  if (!ms) return tl::unexpected(ms.error());
  figures.device_ms = *ms;
  figures.range = s.plan.range;
  figures.vertical_exaggeration = s.plan.exaggeration;
  figures.pixels_per_mm = s.plan.panels.front().camera.pixelsPerMm();
  figures.upload.tiles = std::exchange(s.uploaded.tiles, 0);
  figures.upload.bytes = std::exchange(s.uploaded.bytes, 0);
  figures.upload.ms = std::exchange(s.upload_ms, 0.0);
  return figures;
} catch (const std::exception& error) {
  return engine::failure(error.what(), impl_->window.device(), "");
}

std::optional<std::pair<double, double>> WindowStill::pixelOf(int panel, const glm::dvec3& p) const {
  const Impl& s = *impl_;
  if (panel < 0 || panel >= static_cast<int>(s.plan.panels.size())) return std::nullopt;
  const PanelPlan& plan = s.plan.panels[static_cast<std::size_t>(panel)];
  const double unit = plan.field.grid().height_unit.mm;
  const glm::dvec3 scene{plan.placing.first.x + p.x, plan.placing.first.y + p.y,
                         (p.z / unit - plan.uniforms.relief.y) * plan.uniforms.relief.z};
  const glm::dvec2 pixel = plan.camera.pixelOf(scene);
  return std::pair{pixel.x, pixel.y};
}

// Steps along the ray by half a cell until it passes below the surface.
std::optional<Picked> WindowStill::pick(double x, double y) const {
  const Impl& s = *impl_;
  for (std::size_t i = 0; i < s.plan.panels.size(); ++i) {
    const PanelPlan& plan = s.plan.panels[i];
    const Rectangle& plot = plan.plot;
    if (x < plot.x || y < plot.y || x >= plot.x + plot.width || y >= plot.y + plot.height) continue;
    const Ray ray = plan.camera.rayAt({x, y});
    const engine::FieldReader reader = plan.field.reader();
    const glm::dvec2 cell = plan.placing.spacing;
    const double level = std::hypot(ray.along.x / cell.x, ray.along.y / cell.y);
    const double depth = plan.placing.extent().x + plan.placing.extent().y;
    const double step = level > 1e-9 ? 0.5 / level : depth;
    const auto heightAt = [&](const glm::dvec3& at) -> double {
      const double c = (at.x - plan.placing.first.x) / cell.x, r = (at.y - plan.placing.first.y) / cell.y;
      const auto column = static_cast<std::int64_t>(std::floor(c)),
                 row = static_cast<std::int64_t>(std::floor(r));
      const engine::Grid& grid = reader.grid();
      if (!grid.contains(column, row) || !grid.contains(column + 1, row + 1)) return NAN;
      const auto h = [&](int dc, int dr) {
        return static_cast<double>(
            reader.heightAt(static_cast<std::int32_t>(column) + dc, static_cast<std::int32_t>(row) + dr));
      };
      const double u = c - static_cast<double>(column), v = r - static_cast<double>(row);
      return (1 - v) * ((1 - u) * h(0, 0) + u * h(1, 0)) + v * ((1 - u) * h(0, 1) + u * h(1, 1));
    };
    const double mm_per_unit = plan.uniforms.relief.z;
    double before = NAN;
    const double length = 4.0 * depth;
    for (double t = 0.0; t < length; t += step) {
      const glm::dvec3 at = ray.from + t * ray.along;
      const double h = heightAt(at);
      const double above = at.z - (h - plan.uniforms.relief.y) * mm_per_unit;
      if (above <= 0.0 && before > 0.0) {
        const double back = step * above / (above - before);
        const glm::dvec3 on = ray.from + (t + back) * ray.along;
        const double z = heightAt(on);
        Picked picked;
        picked.panel = static_cast<int>(i);
        picked.position_mm = {on.x - plan.placing.first.x, on.y - plan.placing.first.y,
                              z * reader.grid().height_unit.mm};
        picked.column = static_cast<std::int32_t>(picked.position_mm.x / cell.x);
        picked.row = static_cast<std::int32_t>(picked.position_mm.y / cell.y);
        if (!std::isfinite(z)) return std::nullopt;
        return picked;
      }
      before = above;
    }
  }
  return std::nullopt;
}

}  // namespace fettle::render
