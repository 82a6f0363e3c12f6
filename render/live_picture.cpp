#include "render/live_picture.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "engine/field/difference.h"
#include "render/capture.h"
#include "render/damage.h"
#include "render/live_frame.h"
#include "render/live_overlay.h"
#include "render/live_view.h"
#include "render/page_demand.h"
#include "render/pick.h"
#include "render/stereo_compose.h"

namespace fettle::render {
namespace {

using Clock = std::chrono::steady_clock;

double msSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

constexpr vk::DeviceSize kStagingBytes = vk::DeviceSize{64} << 20U;
constexpr float kSeamPx = 0.25F;

engine::Error errorOf(const std::string& device, const char* what) {
  return engine::failure(fmt::format("drawing failed ({})", what), device, "start the picture anew").value();
}

bool related(const engine::Version& a, const engine::Version& b) {
  return !a.empty() && !b.empty() && a.memory() == b.memory() && a.grid().width == b.grid().width &&
         a.grid().height == b.grid().height;
}

bool holed(const engine::Version& v) {
  return v.reader().root().holed_children != 0;
}

// The finest level that stays on the device for good: what a quarter of the pool holds if `textures` of them
// do. The coarsest patch, which is drawn when nothing else can be, has vertices every 2^top samples and looks
// for heights beside holes at an eighth of that: those are there in any case.
int fixedLevel(const engine::Grid& grid, const PagePool& pool, std::size_t textures) {
  int top = 0;
  while ((std::max(grid.width, grid.height) - 2) / DetailMeasure::side(top) > 0) ++top;
  const int coarsest = std::clamp((top - 3) / 2, 0, kDataLevels - 1);
  const PageGrid pages(grid.width, grid.height, pool.log2Side());
  int level = 0;
  while (level<coarsest&& static_cast<std::uint64_t>(PageSet::fixedPages(pages, level)) * textures * 4> pool
             .slots()
             .count())
    ++level;
  return level;
}

// A line of sight in field coordinates: where it comes from and where it goes.
Ray inField(const PanelPlan& p, const Ray& ray) {
  const double unit = p.field.grid().height_unit.mm;
  const auto field = [&](const glm::dvec3& s) {
    return glm::dvec3(glm::dvec2(s) - p.placing.first, (s.z / p.mm_per_unit + p.reference) * unit);
  };
  const glm::dvec3 from = field(ray.from);
  return {from, field(ray.from + ray.along) - from};
}
glm::dvec3 inScene(const PanelPlan& p, const glm::dvec3& field_mm) {
  const double unit = p.field.grid().height_unit.mm;
  return {p.placing.first + glm::dvec2(field_mm), (field_mm.z / unit - p.reference) * p.mm_per_unit};
}

// Where the window stands that the surface in the middle of the plot lies on (Stereo::screen_distance).
double windowAtMiddle(const PanelPlan& p) {
  const glm::dvec2 middle(p.plot.x + 0.5 * p.plot.width, p.plot.y + 0.5 * p.plot.height);
  const Ray ray = inField(p, p.camera.rayAt(middle));
  const auto hit = meetSurface(p.field.reader(), ray.from, ray.along);
  if (!hit) return 1.0;
  glm::dvec3 at = inScene(p, hit->position_mm);
  // Heights are drawn cut.
  at.z = std::clamp(at.z, p.floor_z, p.cut_z);
  return std::clamp(p.camera.windowOf(at), 0.1, 10.0);
}

std::uint64_t largestHeap(const vk::raii::PhysicalDevice& device) {
  const vk::PhysicalDeviceMemoryProperties memory = device.getMemoryProperties();
  vk::DeviceSize largest = 0;
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (memory.memoryHeaps[i].flags & vk::MemoryHeapFlagBits::eDeviceLocal)
      largest = std::max(largest, memory.memoryHeaps[i].size);
  return largest;
}

// Off-screen image that a frame is drawn to and copied out of.
struct Canvas {
  GpuImage image;
  [[nodiscard]] LiveTarget target() const {
    LiveTarget t;
    t.image = image.image();
    t.view = image.view();
    t.extent = image.extent();
    t.leaves_as = vk::ImageLayout::eTransferSrcOptimal;
    return t;
  }
};

// Where the panels lie: as layOut has them in a row, or two rows of two or three.
render::Layout arranged(const FrameInput& input, int versions) {
  const bool titled =
      std::any_of(input.titles.begin(), input.titles.end(), [](const auto& t) { return !t.empty(); });
  const Titles titles = titled ? Titles::kAbove : Titles::kNone;
  if (input.arrangement == Arrangement::kSplit && versions >= 2) {
    render::Layout layout = layOut(input.view, input.decoration, 1, titles, input.furniture_scale);
    layout.plots.push_back(layout.plots.front());
    return layout;
  }
  if (versions < 4) return layOut(input.view, input.decoration, versions, titles, input.furniture_scale);
  render::Layout layout =
      layOut(input.view, input.decoration, (versions + 1) / 2, titles, input.furniture_scale);
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

struct LivePicture::Impl {
  std::unique_ptr<Context> own;  // empty when somebody else's is used
  Context& context;
  LiveOptions options;
  std::uint32_t max_side = 0;
  Glyphs glyphs;
  Submissions submissions;
  StagingRing staging;
  vk::Format colour_format;
  LiveFrame frame;
  // For two eyes: made when first asked for.
  std::unique_ptr<StereoCompose> compose;
  std::unique_ptr<LiveFrame> both_eyes;  // in one pass
  std::unique_ptr<LiveFrame> right_eye;  // in a pass of its own; the left one is `frame`

  Shown shown;
  struct Field {
    LiveTexture texture;
    DetailMeasure measure;
    engine::Version measured;  // what `measure` is of, when no tile of the texture is pending
  };
  std::uint64_t memory_budget = 0;
  std::unique_ptr<PagePool> pool;  // null unless pages are there by need
  std::vector<Field> fields;
  LiveTexture original;
  std::optional<PictureSpans> spans;
  UploadStatistics uploaded;  // since the last frame
  Canvas canvas;
  struct Seen {
    PicturePlan plan;
    std::vector<Rectangle> visible;
    std::vector<std::array<Camera, 2>> eyes;  // of each panel; none unless in stereo
    StereoMode stereo = StereoMode::kOff;
    int eye_width = 0;  // of one eye's picture [px]
  };
  std::optional<Seen> seen;
  // What the layers of `frame` show: another frame that differs in the fields alone is drawn in parts.
  struct Drawn {
    struct Panel {
      engine::Version field;
      gpu::PanelUniforms uniforms;
      SurfaceVariant variant;
      int shade_level = 0;
      Rectangle plot, visible;
      PatchChoice choice;
    };
    std::vector<Panel> panels;
    std::vector<gpu::Quad> furniture;
    glm::vec3 ground{0.0F};
    engine::Version original;
    std::optional<engine::Version> accepted;
  };
  std::optional<Drawn> drawn;
  bool broken = false;  // an upload was left half done

  Impl(std::unique_ptr<Context> owned, Context& used, vk::Format colour, const LiveOptions& o, Glyphs g)
      : own(std::move(owned)),
        context(used),
        options(o),
        glyphs(std::move(g)),
        submissions(context),
        staging(context, kStagingBytes),
        colour_format(colour),
        frame(context, colour) {
    max_side = context.limits().maxImageDimension2D;
    if (o.max_image_side > 0)
      max_side = std::min(max_side, static_cast<std::uint32_t>(std::max(64, o.max_image_side)));
    memory_budget = static_cast<std::uint64_t>(std::max<std::int64_t>(0, o.memory_budget_bytes));
    if (memory_budget == 0) memory_budget = largestHeap(context.physical()) / 2;
  }

  engine::Status update(const Shown& next);
  bool wantsPool(const Shown& next) const;
  engine::Status arrangePool(const Shown& next);
  void bringAll(LiveTexture& texture);
  engine::Result<PicturePlan> plan(const FrameInput& input);
  engine::Result<FrameStatistics> draw(const FrameInput& input, const LiveTarget& target);
  void drawOn(const FrameInput& input, const LiveTarget& target, FrameStatistics& stats, PicturePlan plan);
  void recordStereo(const Stereo& stereo, Sharpness sharpness, std::vector<LivePanel>& panels,
                    const std::vector<gpu::Quad>& furniture, const glm::vec3& ground,
                    const LiveTarget& target);
  void bringPages(PageDemand& demand, std::int64_t bytes_left, FrameStatistics& stats);
  bool onlyFieldsDiffer(const Drawn& before, const Drawn& now) const;
  std::vector<PatchChoice> cutToDamage(const Drawn& before, const Drawn& now,
                                       std::span<const PatchQuestion> questions,
                                       std::vector<LivePanel>& panels) const;
  std::vector<gpu::Line> linesOf(const std::vector<OverlayLine>& lines, OverlayLine::Depth depth,
                                 const PanelPlan& panel) const;
};

// All that is pending, however long it takes: before the first picture of a field.
void LivePicture::Impl::bringAll(LiveTexture& texture) {
  std::vector<glm::ivec2> moved;
  while (texture.pending() > 0) {
    if (submissions.begin() > 0.5) ++uploaded.stalls;
    staging.release(submissions.done());
    UploadStatistics count;
    texture.pump(staging, submissions.next(), submissions.commands(), std::int64_t{16} << 20U, count, moved);
    uploaded.tiles += count.tiles;
    uploaded.bytes += count.bytes;
    uploaded.changed_samples += count.changed_samples;
    submissions.submit({});
  }
}

// Whether what is to be shown has to come by need.
bool LivePicture::Impl::wantsPool(const Shown& next) const {
  // Back from a pool means to bring all of a field at once: not between versions of one.
  if (pool && !shown.versions.empty() && related(shown.versions.front(), next.versions.front())) return true;
  std::uint64_t all = 0;
  const auto add = [&](const engine::Version& v, MarksOverlay marks) {
    const std::uint64_t bytes = LiveTexture::bytesOfWhole(context, v.grid(), marks, max_side);
    all = bytes == 0 ? memory_budget + 1 : all + bytes;
    return all <= memory_budget;
  };
  for (const engine::Version& v : next.versions)
    if (!add(v, next.marks)) return true;
  return next.original && !add(*next.original, MarksOverlay::kHide);
}

// The pool that `next` takes, with nothing in it when it is another one than before.
engine::Status LivePicture::Impl::arrangePool(const Shown& next) {
  const bool wants = wantsPool(next);
  const bool marks = next.marks == MarksOverlay::kShow;
  if (wants == (pool != nullptr) && (!wants || pool->hasMarks() || !marks)) return {};
  submissions.finish();
  // The measures are kept: they are of the versions that were wanted as soon as the pending tiles are in
  // them.
  for (Field& f : fields) {
    if (f.texture.pending() > 0) f.measure.forget(f.texture.version().reader(), f.texture.pendingTiles());
    f.texture.clear();
  }
  original.clear();
  pool.reset();
  if (wants)
    pool = std::make_unique<PagePool>(context, memory_budget,
                                      marks ? PagePool::Marks::kBeside : PagePool::Marks::kNone, max_side);
  return {};
}

engine::Status LivePicture::Impl::update(const Shown& next) {
  const auto start = Clock::now();
  if (next.versions.empty() || next.versions.size() > LiveFrame::kMostPanels)
    return engine::inputError(fmt::format("{} versions in one picture", next.versions.size()), "picture",
                              "show one to four");
  const auto fits = [&](const engine::Version& v) {
    return !v.empty() && v.grid().width == next.versions.front().grid().width &&
           v.grid().height == next.versions.front().grid().height;
  };
  if (!std::all_of(next.versions.begin(), next.versions.end(), fits) ||
      (next.original && !fits(*next.original)) ||
      (next.accepted && !related(*next.accepted, next.versions.front())))
    return engine::inputError("the versions have different sizes, or one is empty", "picture",
                              "show states of one field");
  // Whatever is let go below may be read by frames in flight; and a field that fails halfway is forgotten.
  const auto idle = [this] { submissions.finish(); };
  const bool was_broken = broken;
  broken = true;
  if (was_broken) {
    idle();
    fields.clear();
    original.clear();
  }
  if (engine::Status ok = arrangePool(next); !ok) return ok;
  bool fresh = false;
  if (fields.size() > next.versions.size()) idle();
  fields.resize(next.versions.size());
  const auto want = [&](LiveTexture& texture, const engine::Version& v, MarksOverlay marks,
                        const engine::Version& accepted = {}) {
    if (!pool) return texture.want(context, v, marks, max_side, idle, accepted);
    return texture.want(*pool, fixedLevel(v.grid(), *pool, next.versions.size() + 1), v, idle, accepted);
  };
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const engine::Version& v = next.versions[i];
    const auto state = want(fields[i].texture, v, next.marks,
                            i == 0 ? next.accepted.value_or(engine::Version()) : engine::Version());
    if (!state) return tl::unexpected(state.error());
    if (*state != LiveTexture::Freshness::kFresh) {
      if (!shown.versions.empty() && fields[i].texture.pending() > 0 && next.marks != shown.marks) {
        const std::vector<glm::ivec2> tiles = fields[i].texture.pendingTiles();
        bringAll(fields[i].texture);
        fields[i].measure.forget(v.reader(), tiles);
      }
      fields[i].measured = v;
      continue;
    }
    bringAll(fields[i].texture);
    const bool known = related(fields[i].measured, v);
    fresh = fresh || (i == 0 && !known);
    if (known || (i > 0 && related(next.versions[0], v))) {
      std::vector<glm::ivec2> tiles;
      if (!known) {
        fields[i].measure = fields[0].measure;
        tiles = fields[0].texture.pendingTiles();
      }
      for (const engine::TileChange& c :
           engine::changedTiles(known ? fields[i].measured : next.versions[0], v))
        tiles.emplace_back(c.tile_column, c.tile_row);
      fields[i].measure.forget(v.reader(), tiles);
    } else {
      fields[i].measure.begin(v.reader());
    }
    fields[i].measured = v;
  }
  if (next.original) {
    const auto state = want(original, *next.original, MarksOverlay::kHide);
    if (!state) return tl::unexpected(state.error());
    if (*state == LiveTexture::Freshness::kFresh) {
      bringAll(original);
      fresh = true;
    }
  } else if (!original.version().empty()) {
    idle();
    original.clear();
  }
  if (fresh || next.original.has_value() != shown.original.has_value()) spans.reset();
  shown = next;
  broken = false;
  uploaded.ms += msSince(start);
  return {};
}

engine::Result<PicturePlan> LivePicture::Impl::plan(const FrameInput& input) {
  const bool finite = std::isfinite(input.light_azimuth_deg) && input.light_elevation_deg >= 5.0 &&
                      input.light_elevation_deg <= 90.0;
  if (!(input.error_px > 0.0) || input.vertex_budget < 4096 || input.vertex_budget > (1 << 24) || !finite ||
      !(input.split >= 0.0 && input.split <= 1.0))
    return engine::inputError("the error, the budget, the split or the light is out of range", "picture",
                              "see FrameInput");
  PictureSpec spec;
  spec.view = input.view;
  spec.deviation_from = shown.original;
  spec.range = input.range;
  spec.marks = shown.marks;
  spec.marks_opacity = input.marks_opacity;
  spec.map = input.map;
  spec.contours = input.contours;
  spec.decoration = input.decoration;
  spec.theme = input.theme;
  spec.samples_per_side = 1;
  if (!spans) spans = spansOf(shown.versions, shown.original);
  engine::Result<PicturePlan> plan =
      layPicture(spec, shown.versions, *spans, arranged(input, static_cast<int>(shown.versions.size())));
  if (plan) {
    plan->furniture.titles = input.titles;
    const auto anyMark = [](const engine::Version& v) { return v.reader().root().marked_children != 0; };
    // The plan takes the suggested ones for marks.
    if (shown.accepted)
      plan->furniture.marks = shown.marks == MarksOverlay::kShow &&
                              (anyMark(*shown.accepted) ||
                               std::any_of(shown.versions.begin() + 1, shown.versions.end(), anyMark));
    plan->furniture.suggested =
        shown.marks == MarksOverlay::kShow && shown.accepted && !(*shown.accepted == shown.versions.front());
  }
  return plan;
}

std::vector<gpu::Line> LivePicture::Impl::linesOf(const std::vector<OverlayLine>& lines,
                                                  OverlayLine::Depth depth, const PanelPlan& panel) const {
  std::vector<gpu::Line> out;
  const double per_mm = panel.mm_per_unit / panel.field.grid().height_unit.mm;
  const double zero_mm = panel.reference * panel.field.grid().height_unit.mm;
  // A hair towards the viewer, so that a line on the surface is not lost in it.
  const glm::dvec3 lift = (depth == OverlayLine::Depth::kInScene ? 1.5 / panel.camera.pixelsPerMm() : 0.0) *
                          panel.camera.toViewer();
  const auto scene = [&](const glm::dvec3& p) {
    return glm::dvec3(panel.placing.first + glm::dvec2(p), (p.z - zero_mm) * per_mm) + lift;
  };
  for (const OverlayLine& l : lines)
    if (l.depth == depth)
      out.push_back({glm::vec4(glm::vec3(scene(l.from_mm)), l.width_px),
                     glm::vec4(glm::vec3(scene(l.to_mm)), 0.0F), glm::vec4(l.colour, l.opacity)});
  return out;
}

engine::Result<FrameStatistics> LivePicture::Impl::draw(const FrameInput& input, const LiveTarget& target) {
  if (shown.versions.empty() || broken)
    return engine::inputError("there is no field to draw", "picture", "give it a version first");
  if (input.stereo.mode == StereoMode::kSideBySide &&
      input.view.width == static_cast<int>(target.extent.width)) {
    // Each eye's picture is laid out for its half.
    FrameInput eye = input;
    eye.view.width = static_cast<int>(StereoCompose::eyeExtent(input.stereo.mode, target.extent).width);
    return draw(eye, target);
  }
  if (engine::Status ok = check(input.stereo); !ok) return tl::unexpected(ok.error());
  engine::Result<PicturePlan> planned = plan(input);
  if (!planned) return tl::unexpected(planned.error());
  for (const Rectangle& plot : planned->layout.plots)
    if (plot.width < 8 || plot.height < 8)
      return engine::inputError(fmt::format("a picture of {} x {} pixels leaves no room for the surface",
                                            input.view.width, input.view.height),
                                "picture size", "make it larger, or leave the furniture out");
  FrameStatistics stats;
  drawOn(input, target, stats, *std::move(planned));
  return stats;
}

// Pages that this frame asks for, within what is left of its bytes.
void LivePicture::Impl::bringPages(PageDemand& demand, std::int64_t bytes_left, FrameStatistics& stats) {
  UploadStatistics count;
  ResidencyStatistics& r = stats.residency;
  const PageDemand::Outcome outcome =
      demand.settle(*pool, staging, submissions.next(), submissions.commands(), bytes_left, count);
  stats.upload.bytes += count.bytes;
  stats.upload.pending_tiles += count.pending_tiles;
  r.by_need = true;
  r.device_bytes = static_cast<std::int64_t>(pool->bytes());
  r.pages = pool->slots().count();
  r.pages_used = pool->slots().used();
  r.pages_asked = outcome.asked;
  r.pages_loaded = outcome.loaded;
  r.pages_waiting = outcome.waiting;
  r.pages_beyond = outcome.beyond;
}

void LivePicture::Impl::recordStereo(const Stereo& stereo, Sharpness sharpness,
                                     std::vector<LivePanel>& panels, const std::vector<gpu::Quad>& furniture,
                                     const glm::vec3& ground, const LiveTarget& target) {
  const bool one_pass = stereo.passes == Stereo::Passes::kBest  ? context.multiviewWorks()
                        : stereo.passes == Stereo::Passes::kOne ? context.multiview()
                                                                : false;
  if (!compose) compose = std::make_unique<StereoCompose>(context, colour_format);
  compose->begin(submissions, StereoCompose::eyeExtent(stereo.mode, target.extent),
                 one_pass ? StereoCompose::Layers::kOneImage : StereoCompose::Layers::kTwoImages);
  if (one_pass) {
    if (!both_eyes) both_eyes = std::make_unique<LiveFrame>(context, colour_format, Pipelines::Views::kBoth);
    both_eyes->record(submissions, staging, panels, furniture, ground, glyphs, compose->target(Eye::kLeft),
                      LiveFrame::Redraw::kAll, sharpness);
  } else {
    frame.record(submissions, staging, panels, furniture, ground, glyphs, compose->target(Eye::kLeft),
                 LiveFrame::Redraw::kAll, sharpness);
    for (LivePanel& panel : panels) panel.uniforms.views[0] = panel.uniforms.views[1];
    if (!right_eye) right_eye = std::make_unique<LiveFrame>(context, colour_format);
    right_eye->record(submissions, staging, panels, furniture, ground, glyphs, compose->target(Eye::kRight),
                      LiveFrame::Redraw::kAll, sharpness);
  }
  compose->record(submissions.commands(), stereo.mode, target);
}

bool LivePicture::Impl::onlyFieldsDiffer(const Drawn& before, const Drawn& now) const {
  // Pages that come and go change the surface without any change to the field.
  if (pool || before.panels.size() != now.panels.size() || before.ground != now.ground ||
      !(before.original == now.original) || !(before.accepted == now.accepted) ||
      before.furniture.size() != now.furniture.size())
    return false;
  // Plain numbers without gaps, and equal bits draw equal pictures.
  if (!now.furniture.empty() && std::memcmp(before.furniture.data(), now.furniture.data(),
                                            now.furniture.size() * sizeof(gpu::Quad)) != 0)
    return false;
  for (std::size_t i = 0; i < now.panels.size(); ++i) {
    const Drawn::Panel &a = before.panels[i], &b = now.panels[i];
    const auto same = [](const Rectangle& x, const Rectangle& y) {
      return x.x == y.x && x.y == y.y && x.width == y.width && x.height == y.height;
    };
    if (!related(a.field, b.field) || a.variant != b.variant || a.shade_level != b.shade_level ||
        !same(a.plot, b.plot) || !same(a.visible, b.visible) ||
        std::memcmp(&a.uniforms, &b.uniforms, sizeof(a.uniforms)) != 0)
      return false;
  }
  return true;
}

// Sets what of each panel is to be drawn anew, and lets the panels' choices be cut down to that.
std::vector<PatchChoice> LivePicture::Impl::cutToDamage(const Drawn& before, const Drawn& now,
                                                        std::span<const PatchQuestion> questions,
                                                        std::vector<LivePanel>& panels) const {
  std::vector<PatchChoice> parts(panels.size());
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const std::vector<engine::TileChange> tiles =
        engine::changedTiles(before.panels[i].field, now.panels[i].field);
    DamageQuestion q;
    q.now = questions[i];
    q.before = before.panels[i].field.reader();
    q.tiles = tiles;
    q.chosen_before = &before.panels[i].choice;
    q.chosen_after = panels[i].choice;
    q.visible = panels[i].visible;
    panels[i].redraw = damageOf(q);
    parts[i] = within(*panels[i].choice, questions[i], panels[i].redraw);
    panels[i].choice = &parts[i];
  }
  return parts;
}

void LivePicture::Impl::drawOn(const FrameInput& input, const LiveTarget& target, FrameStatistics& stats,
                               PicturePlan plan) {
  stats.wait_ms = submissions.begin();
  const auto start = Clock::now();
  staging.release(submissions.done());

  // What changed: to the device, and into the measures that patches are chosen by.
  UploadStatistics count;
  std::vector<glm::ivec2> moved;
  for (Field& f : fields) {
    moved.clear();
    f.texture.pump(staging, submissions.next(), submissions.commands(), options.upload_bytes_a_frame, count,
                   moved);
    const engine::FieldReader reader = f.texture.version().reader();
    if (!moved.empty()) f.measure.forget(reader, moved);
    count.measured_tiles += static_cast<std::int64_t>(f.measure.measureSome(reader, kMeasuredAFrame));
    count.unmeasured_tiles += static_cast<std::int64_t>(f.measure.unknown());
  }
  moved.clear();
  if (!original.version().empty())
    original.pump(staging, submissions.next(), submissions.commands(), options.upload_bytes_a_frame, count,
                  moved);
  stats.upload = uploaded;
  stats.upload.tiles += count.tiles;
  stats.upload.bytes += count.bytes;
  stats.upload.changed_samples += count.changed_samples;
  stats.upload.measured_tiles = count.measured_tiles;
  stats.upload.unmeasured_tiles = count.unmeasured_tiles;
  stats.upload.pending_tiles = count.pending_tiles + count.unmeasured_tiles;
  const double pumped_ms = msSince(start);
  stats.upload.ms += pumped_ms;
  uploaded = {};

  const auto select_start = Clock::now();
  const bool split = input.arrangement == Arrangement::kSplit && fields.size() >= 2;
  const std::size_t count_panels = split ? 2 : plan.panels.size();
  std::vector<PatchTree> trees;
  std::vector<PatchQuestion> questions;
  std::vector<PatchChoice> choices(count_panels);
  std::vector<LivePanel> panels(count_panels);
  PageDemand demand;
  Seen now;
  const bool stereo = input.stereo.mode != StereoMode::kOff;
  const bool half = input.sharpness == Sharpness::kHalf;
  now.stereo = input.stereo.mode;
  now.eye_width = input.view.width;
  const double window = !stereo                              ? 1.0
                        : input.stereo.screen_distance > 0.0 ? input.stereo.screen_distance
                                                             : windowAtMiddle(plan.panels.front());
  std::vector<OverlayLine> lines = input.overlays.lines;
  for (const Overlays::Ring& ring : input.overlays.rings)
    appendRing(shown.versions.front().reader(), ring, lines);
  for (std::size_t i = 0; i < count_panels; ++i) {
    const PanelPlan& p = plan.panels[i];
    LivePanel& panel = panels[i];
    // Colours from samples about a pixel apart: in perspective the near part is larger than the middle.
    const glm::dvec2 px = cellPixels(p.placing, p.camera);
    const double nearer = input.view.projection == Projection::kPerspective ? 2.0 : 1.0;
    while (panel.shade_level + 1 < LiveTexture::kLevels &&
           std::ldexp(std::max(px.x, px.y) * nearer, LiveTexture::shift(panel.shade_level + 1)) <= 1.0)
      ++panel.shade_level;
    const int shift = LiveTexture::shift(panel.shade_level);
    PatchQuestion q;
    q.shade_step = 1 << shift;
    q.measure = &fields[i].measure;
    q.reader = p.field.reader();
    if (fields[i].texture.pending() > 0)
      q.settled = [&texture = fields[i].texture](glm::ivec2 first, glm::ivec2 last) {
        return !texture.anyPending(first / engine::kTileSide, last / engine::kTileSide);
      };
    q.placing = p.placing;
    q.camera = p.camera;
    if (stereo) {
      now.eyes.push_back(eyesOf(p.camera, input.stereo, window));
      q.camera = now.eyes[i][0];
      q.other_eye = now.eyes[i][1];
    }
    q.mm_per_unit = p.mm_per_unit;
    q.reference = p.reference;
    q.lowest = p.lowest;
    q.highest = p.highest;
    q.floor_z = p.floor_z;
    q.error_px = input.error_px;
    q.vertex_budget = input.vertex_budget / static_cast<std::int64_t>(count_panels);
    trees.emplace_back(q);
    questions.push_back(q);

    panel.plot = panel.visible = p.plot;
    if (split) {
      // On an even column of the picture: no square of two by two fragments belongs to both sides.
      const int wanted = static_cast<int>(std::lround(input.split * p.plot.width));
      const int at = std::min(wanted + ((p.plot.x + wanted) & 1), p.plot.width);
      if (i == 0)
        panel.visible.width = at;
      else
        panel.visible = {p.plot.x + at, p.plot.y, p.plot.width - at, p.plot.height};
    }
    now.visible.push_back(panel.visible);
    panel.field = &fields[i].texture;
    panel.original = original.version().empty() ? nullptr : &original;
    panel.uniforms = p.uniforms;
    gpu::PanelUniforms& u = panel.uniforms;
    if (shift > 0) {
      u.shade = glm::ivec4(shift, 0, glm::max((p.placing.true_size - 1) / (1 << shift) + 1, glm::ivec2(2)));
      u.paging.w = std::max(
          1, static_cast<int>(std::lround(0.5 / std::max(1e-6, std::ldexp(std::min(px.x, px.y), shift)))));
    }
    u.seam.x = half ? 2.0F * kSeamPx : kSeamPx;
    u.views[0] = viewOf(q.camera, p.placing, p.plot);
    if (q.other_eye) u.views[1] = viewOf(*q.other_eye, p.placing, p.plot);
    u.ground = glm::vec4(plan.palette.ground, 1.0F);
    const Paging& paging = panel.field->paging();
    u.paging.x = paging.log2_columns;
    u.paging.y = paging.log2_rows;
    u.paging.z = static_cast<int>(paging.across);
    const double azimuth = input.light_azimuth_deg * std::numbers::pi / 180.0;
    const double up = std::sin(input.light_elevation_deg * std::numbers::pi / 180.0);
    const glm::dvec3 right = p.camera.right();
    const glm::dvec3 away{-right.y, right.x, 0.0};
    const glm::dvec3 level = std::cos(azimuth) * right + std::sin(azimuth) * away;
    u.light = glm::vec4(glm::vec3(std::sqrt(std::max(0.0, 1.0 - up * up)) * level + glm::dvec3(0.0, 0.0, up)),
                        u.light.w);
    panel.variant = {paging.paged(),
                     shown.marks == MarksOverlay::kShow,
                     panel.original != nullptr,
                     input.contours == Contours::kShow,
                     std::max(px.x, px.y) > 1.5,
                     holed(p.field) || (panel.original != nullptr && holed(original.version())),
                     true,
                     pool != nullptr,
                     pool == nullptr && !paging.paged() &&
                         std::min(p.placing.true_size.x, p.placing.true_size.y) > 1 << shift,
                     input.view.projection == Projection::kPerspective};
    if (pool)
      demand.want(trees[i], fields[i].texture, panel.original != nullptr ? &original : nullptr,
                  panel.shade_level, u.paging.w, submissions.next());
    panel.in_scene = linesOf(lines, OverlayLine::Depth::kInScene, p);
    panel.on_top = linesOf(lines, OverlayLine::Depth::kOnTop, p);
  }
  if (pool) bringPages(demand, options.upload_bytes_a_frame - count.bytes, stats);
  for (std::size_t i = 0; i < count_panels; ++i) {
    if (pool) {
      const PageSet& pages = *fields[i].texture.pages();
      trees[i].prune([&](const PatchLeaf& leaf) { return PageDemand::drawable(leaf, pages); });
      panels[i].uniforms.pages = pageHead(pages.grid());
      panels[i].pages = pageTable(pages, panels[i].original != nullptr ? original.pages() : nullptr);
    }
    choices[i] = trees[i].list();
    panels[i].choice = &choices[i];
    stats.patches += static_cast<std::int64_t>(choices[i].patches.size());
    stats.vertices += choices[i].vertices();
    stats.triangles += choices[i].triangles();
    stats.bound_px = std::max(stats.bound_px, choices[i].bound_px);
    stats.within_budget = stats.within_budget && choices[i].within_budget;
  }

  std::vector<std::string> warnings;
  if (glyphs.used() > Glyphs::kSide / 2) glyphs.clear();
  std::vector<gpu::Quad> furniture =
      furnish(plan.layout, input.view, plan.furniture, plan.palette, glyphs, warnings);
  if (split) {
    const Rectangle& right = now.visible[1];
    gpu::Quad line{};
    line.pixels = glm::vec4(right.x - 1, right.y, right.x + 1, right.y + right.height);
    line.colour = glm::vec4(plan.palette.ink, 1.0F);
    line.fill = glm::ivec4(gpu::kFillSolid, 1, 0, 0);
    furniture.push_back(line);
  }

  Drawn layers;
  for (std::size_t i = 0; i < count_panels; ++i) {
    const LivePanel& panel = panels[i];
    layers.panels.push_back({fields[i].texture.version(), panel.uniforms, panel.variant, panel.shade_level,
                             panel.plot, panel.visible, *panel.choice});
  }
  layers.furniture = furniture;
  layers.ground = plan.palette.ground;
  layers.original = original.version();
  layers.accepted = shown.accepted;
  std::optional<Drawn> before;
  before.swap(drawn);  // until this frame is handed over, nobody knows what the layers hold
  std::vector<PatchChoice> parts;
  const bool some = !stereo && !half && input.redraw == FrameInput::Redraw::kChanged && before &&
                    stats.upload.pending_tiles == 0 && frame.holds(target.extent) &&
                    (furniture.empty() || frame.holds(glyphs)) && onlyFieldsDiffer(*before, layers);
  if (some) parts = cutToDamage(*before, layers, questions, panels);
  double plots_px = 0.0, redrawn_px = 0.0;
  for (const LivePanel& panel : panels) {
    plots_px += static_cast<double>(panel.visible.width) * panel.visible.height;
    redrawn_px += static_cast<double>(panel.redraw.width) * panel.redraw.height;
  }
  if (some) stats.redrawn = redrawn_px / std::max(1.0, plots_px);
  stats.select_ms = msSince(select_start);

  if (stereo)
    recordStereo(input.stereo, input.sharpness, panels, furniture, plan.palette.ground, target);
  else
    frame.record(submissions, staging, panels, furniture, plan.palette.ground, glyphs, target,
                 some ? LiveFrame::Redraw::kParts : LiveFrame::Redraw::kAll, input.sharpness);
  submissions.submit({target.free,
                      vk::PipelineStageFlagBits2::eCopy | vk::PipelineStageFlagBits2::eColorAttachmentOutput,
                      target.done});
  if (!stereo && !half && stats.upload.pending_tiles == 0) drawn = std::move(layers);
  stats.device_ms = submissions.lastMs();
  stats.range = plan.range;
  stats.vertical_exaggeration = plan.exaggeration;
  stats.pixels_per_mm = plan.panels.front().camera.pixelsPerMm();
  stats.record_ms = msSince(start) - stats.select_ms - pumped_ms;
  now.plan = std::move(plan);
  seen = std::move(now);
}

LivePicture::LivePicture(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LivePicture::~LivePicture() = default;

engine::Result<std::unique_ptr<LivePicture>> LivePicture::create(const LiveOptions& options) {
  RendererOptions wanted;
  wanted.validation = options.validation;
  wanted.device = options.device;
  auto context = Context::create(wanted);
  if (!context) return tl::unexpected(context.error());
  auto glyphs = Glyphs::create();
  if (!glyphs) return tl::unexpected(glyphs.error());
  Context& used = **context;
  const std::string name = used.name();
  try {
    return std::unique_ptr<LivePicture>(new LivePicture(
        std::make_unique<Impl>(*std::move(context), used, kColourFormat, options, *std::move(glyphs))));
  } catch (const std::exception& error) {
    return tl::unexpected(errorOf(name, error.what()));
  }
}

engine::Result<std::unique_ptr<LivePicture>> LivePicture::create(Context& context,
                                                                 std::uint32_t colour_format,
                                                                 const LiveOptions& options) {
  auto glyphs = Glyphs::create();
  if (!glyphs) return tl::unexpected(glyphs.error());
  try {
    return std::unique_ptr<LivePicture>(new LivePicture(std::make_unique<Impl>(
        nullptr, context, static_cast<vk::Format>(colour_format), options, *std::move(glyphs))));
  } catch (const std::exception& error) {
    return tl::unexpected(errorOf(context.name(), error.what()));
  }
}

engine::Status LivePicture::update(const Shown& shown) {
  try {
    return impl_->update(shown);
  } catch (const std::exception& error) {
    return tl::unexpected(errorOf(impl_->context.name(), error.what()));
  }
}

engine::Status LivePicture::update(const engine::Version& version) {
  Shown next = impl_->shown;
  next.versions = {version};
  next.original.reset();
  return update(next);
}

engine::Result<FrameStatistics> LivePicture::draw(const FrameInput& input, LiveTarget& target) {
  try {
    FrameInput sized = input;
    sized.view.width = static_cast<int>(target.extent.width);
    sized.view.height = static_cast<int>(target.extent.height);
    return impl_->draw(sized, target);
  } catch (const std::exception& error) {
    return tl::unexpected(errorOf(impl_->context.name(), error.what()));
  }
}

engine::Result<FrameStatistics> LivePicture::drawAndWait(const FrameInput& input) {
  try {
    const auto start = Clock::now();
    if (input.view.width < 16 || input.view.height < 16 || input.view.width > 16384 ||
        input.view.height > 16384)
      return engine::inputError(
          fmt::format("a picture of {} x {} pixels", input.view.width, input.view.height), "picture size",
          "give 16 to 16384 pixels each way");
    const vk::Extent2D extent{static_cast<std::uint32_t>(input.view.width),
                              static_cast<std::uint32_t>(input.view.height)};
    if (impl_->canvas.image.extent() != extent) {
      impl_->submissions.finish();
      impl_->canvas.image =
          GpuImage(impl_->context, kColourFormat, extent, 1, GpuImage::Kind::kPlane,
                   vk::ImageUsageFlagBits::eColorAttachment | vk::ImageUsageFlagBits::eTransferSrc |
                       vk::ImageUsageFlagBits::eTransferDst,
                   vk::ImageAspectFlagBits::eColor);
    }
    engine::Result<FrameStatistics> stats = impl_->draw(input, impl_->canvas.target());
    if (!stats) return stats;
    impl_->submissions.finish();
    stats->device_ms = impl_->submissions.lastMs();
    stats->wait_ms = msSince(start) - stats->record_ms - stats->select_ms - stats->upload.ms;
    return stats;
  } catch (const std::exception& error) {
    return tl::unexpected(errorOf(impl_->context.name(), error.what()));
  }
}

engine::Result<FrameStatistics> LivePicture::draw(const FrameInput& input, Image& out) {
  engine::Result<FrameStatistics> stats = drawAndWait(input);
  if (!stats) return stats;
  try {
    const GpuImage& from = impl_->canvas.image;
    Image image;
    image.width = input.view.width;
    image.height = input.view.height;
    image.rgba.resize(std::size_t{4} * from.extent().width * from.extent().height);
    const Buffer buffer(impl_->context, image.rgba.size(), vk::BufferUsageFlagBits::eTransferDst);
    Submissions& submissions = impl_->submissions;
    (void)submissions.begin();
    copyToHost(submissions.commands(), from, buffer);
    submissions.submit({});
    submissions.finish();
    std::memcpy(image.rgba.data(), buffer.data(), image.rgba.size());
    out = std::move(image);
    return stats;
  } catch (const std::exception& error) {
    return tl::unexpected(errorOf(impl_->context.name(), error.what()));
  }
}

std::optional<Picked> LivePicture::pick(double x, double y) const {
  if (!impl_->seen) return std::nullopt;
  const Impl::Seen& seen = *impl_->seen;
  const bool halves = seen.stereo == StereoMode::kSideBySide;
  const bool right = halves && x >= seen.eye_width;
  if (right) x -= seen.eye_width;
  for (std::size_t i = 0; i < seen.visible.size(); ++i) {
    const Rectangle& r = seen.visible[i];
    if (x < r.x || y < r.y || x >= r.x + r.width || y >= r.y + r.height) continue;
    const PanelPlan& p = seen.plan.panels[i];
    const Camera& camera = halves ? seen.eyes[i][right ? 1 : 0] : p.camera;
    const Ray ray = inField(p, camera.rayAt({x, y}));
    const auto hit = meetSurface(p.field.reader(), ray.from, ray.along);
    if (!hit) return std::nullopt;
    return Picked{static_cast<int>(i), hit->position_mm, hit->column, hit->row};
  }
  return std::nullopt;
}

std::optional<std::pair<double, double>> LivePicture::pixelOf(int panel, const glm::dvec3& field_mm,
                                                              Eye eye) const {
  if (!impl_->seen || panel < 0 || static_cast<std::size_t>(panel) >= impl_->seen->visible.size())
    return std::nullopt;
  const Impl::Seen& seen = *impl_->seen;
  const auto i = static_cast<std::size_t>(panel);
  const PanelPlan& p = seen.plan.panels[i];
  const bool stereo = seen.stereo != StereoMode::kOff;
  const Camera& camera = stereo ? seen.eyes[i][static_cast<std::size_t>(eye)] : p.camera;
  const glm::dvec2 at = camera.pixelOf(inScene(p, field_mm));
  const bool right = seen.stereo == StereoMode::kSideBySide && eye == Eye::kRight;
  return std::pair{at.x + (right ? seen.eye_width : 0), at.y};
}

void LivePicture::refreshRanges() {
  impl_->spans.reset();
}

void LivePicture::finish() {
  try {
    impl_->submissions.finish();
  } catch (const vk::SystemError&) {
    // Lost: nothing is under way.
  }
}

const std::string& LivePicture::device() const noexcept {
  return impl_->context.name();
}

std::vector<std::string> LivePicture::validationMessages() const {
  return impl_->context.messages().all();
}

}  // namespace fettle::render
