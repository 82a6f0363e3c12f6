#include "render/live/live_picture.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "engine/base/stopwatch.h"
#include "render/live/live_eyes.h"
#include "render/live/live_fields.h"
#include "render/live/live_frame.h"
#include "render/live/live_panels.h"
#include "render/live/live_plan.h"
#include "render/live/seen_frame.h"
#include "render/live/shown_layers.h"
#include "render/live/stereo_compose.h"
#include "render/vulkan/memory.h"

namespace fettle::render {
namespace {

engine::Error errorOf(const std::string& device, const char* what) {
  return engine::failure(fmt::format("drawing failed ({})", what), device, "create the picture again")
      .value();
}

// Off-screen image that a frame is drawn to and copied out of.
struct Canvas {
  GpuImage image;
  std::uint64_t kept = 0;  // images so far
  [[nodiscard]] LiveTarget target() const {
    LiveTarget t;
    t.image = image.image();
    t.view = image.view();
    t.extent = image.extent();
    t.leaves_as = vk::ImageLayout::eTransferSrcOptimal;
    t.kept = kept;
    return t;
  }
};

std::shared_ptr<LivePrograms> programsOf(const Context& context, vk::Format format) {
  return std::make_shared<LivePrograms>(context, format, Pipelines::Views::kOne);
}

// Keeps the quads that a part of the picture shows, in the pixels of the part.
void restrictTo(const Rectangle& part, std::vector<gpu::Quad>& quads) {
  const glm::vec4 first(part.x, part.y, part.x, part.y);
  std::erase_if(quads, [&](const gpu::Quad& q) {
    return q.pixels.z <= first.x || q.pixels.w <= first.y ||
           q.pixels.x >= first.x + static_cast<float>(part.width) ||
           q.pixels.y >= first.y + static_cast<float>(part.height);
  });
  for (gpu::Quad& q : quads) q.pixels -= first;
}

engine::Status checkPart(const FrameInput& input) {
  if (!input.part) return {};
  const Rectangle& part = *input.part;
  if (empty(part) || !(cut(part, {0, 0, input.view.width, input.view.height}) == part) || part.x % 2 != 0 ||
      part.y % 2 != 0)
    return engine::inputError("the part lies outside the picture, or begins within a square of 2 x 2 pixels",
                              "picture", "see FrameInput");
  return {};
}

// Size of the image that is drawn for an input [px].
vk::Extent2D extentOf(const FrameInput& input) {
  if (!input.part)
    return {static_cast<std::uint32_t>(input.view.width), static_cast<std::uint32_t>(input.view.height)};
  const int eyes = input.stereo.mode == StereoMode::kSideBySide ? 2 : 1;
  return {static_cast<std::uint32_t>(eyes * input.part->width),
          static_cast<std::uint32_t>(input.part->height)};
}

// The cameras of a headset's eyes, of which the left one takes the place of the view's; none without them.
std::optional<std::array<Camera, 2>> headCameras(const FrameInput& input, PicturePlan& plan) {
  if (!input.eyes) return std::nullopt;
  PanelPlan& panel = plan.panels.front();
  const std::array<EyeView, 2> eyes = input.eyes(panel.framing);
  const auto of = [&](const EyeView& eye) { return Camera::ofEye(eye, panel.framing.drawn, panel.plot); };
  const std::array<Camera, 2> cameras{of(eyes[0]), of(eyes[1])};
  panel.camera = cameras[0];
  return cameras;
}

}  // namespace

struct LivePicture::Impl {
  std::unique_ptr<Context> own;  // empty when the context belongs to the caller
  Context& context;
  vk::Format colour_format;
  Glyphs glyphs;
  Submissions submissions;
  StagingRing staging;
  LiveFrame frame;
  LiveEyes eyes;
  LiveFields fields;
  std::optional<PictureSpans> spans;
  bool colours_outdated = false;  // spans->colours are of a state before
  PatchTreeCache patch_tree_cache;
  Canvas canvas;
  std::optional<SeenFrame> seen;
  ShownLayers layers;  // of `frame`
  // The picture with four rays per pixel that is drawn at Sharpness::kRest: what it shows, and how many of its bands are drawn.
  struct Rest {
    DrawnFrame shown;
    int bands = 0;
  };
  std::optional<Rest> rest;
  PatchTreeCache rest_trees;
  std::optional<View> rest_refused;  // a view for which there is no memory

  Impl(std::unique_ptr<Context> owned, Context& used, vk::Format colour, const LiveOptions& options, Glyphs g,
       std::shared_ptr<LivePrograms> programs)
      : own(std::move(owned)),
        context(used),
        colour_format(colour),
        glyphs(std::move(g)),
        submissions(context),
        staging(context, kStagingBytes),
        frame(context, colour, Pipelines::Views::kOne, std::move(programs)),
        eyes(context, submissions, staging, glyphs, frame, colour),
        fields(context, submissions, staging, options) {}
  Impl& operator=(Impl&&) = delete;
  ~Impl();

  engine::Status update(const Shown& next);
  engine::Result<FrameStatistics> draw(const FrameInput& input, const LiveTarget& target);
  void drawOn(const FrameInput& input, const LiveTarget& target, FrameStatistics& stats, PicturePlan plan);
  void recordRest(const FrameInput& input, const PicturePlan& plan, const std::vector<gpu::Quad>& decorations,
                  const LiveTarget& target, FrameStatistics& stats);
  void uploadPages(LivePanels& chosen, FrameInput::Pages pages, FrameStatistics& stats);
  std::vector<gpu::Quad> decorationsOf(const FrameInput& input, const PicturePlan& plan,
                                       std::vector<std::string>& warnings);
  DrawnFrame drawnFrameOf(const std::vector<LivePanel>& panels, const PicturePlan& plan,
                          const std::vector<gpu::Quad>& decorations);
};

LivePicture::Impl::~Impl() {
  // The members declared below `submissions` are destroyed before it, and uploads may still read and write
  // them.
  try {
    submissions.finish();
  } catch (const vk::SystemError&) {
    // A lost device has no work in progress.
  }
}

engine::Status LivePicture::Impl::update(const Shown& next) {
  const engine::Result<LiveFields::Change> change = fields.update(next);
  if (!change) return tl::unexpected(change.error());
  if (*change == LiveFields::Change::kAnother) spans.reset();
  // Not computed again: inverted twice, the picture is as before, regardless of edits in between.
  if (*change == LiveFields::Change::kInverted && spans) spans = negated(*spans);
  return {};
}

engine::Result<FrameStatistics> LivePicture::Impl::draw(const FrameInput& input, const LiveTarget& target) {
  if (!fields.ready())
    return engine::inputError("there is no field to draw", "picture", "give it a version first");
  if (!input.part && input.stereo.mode == StereoMode::kSideBySide &&
      input.view.width == static_cast<int>(target.extent.width)) {
    // Each eye's picture is laid out for its half.
    FrameInput eye = input;
    eye.view.width = static_cast<int>(StereoCompose::eyeExtent(input.stereo.mode, target.extent).width);
    return draw(eye, target);
  }
  if (engine::Status ok = check(input.stereo); !ok) return tl::unexpected(ok.error());
  if (input.eyes &&
      (fields.shown().versions.size() != 1 || input.stereo.mode != StereoMode::kOff || input.part ||
       input.view.projection != Projection::kPerspective || input.decoration != Decoration::kNone))
    return engine::inputError(
        "a headset's eyes see a whole picture of one version in perspective, without decorations", "picture",
        "see FrameInput::eyes");
  const Shown& shown = fields.shown();
  if (!spans)
    spans = spansOf(shown.versions, shown.original);
  else if (colours_outdated)
    spans->colours = spansOf(shown.versions, shown.original).colours;
  colours_outdated = false;
  engine::Result<PicturePlan> planned = planFrame(input, shown, *spans);
  if (!planned) return tl::unexpected(planned.error());
  for (const Rectangle& plot : planned->layout.plots)
    if (plot.width < 8 || plot.height < 8)
      return engine::inputError(fmt::format("a picture of {} x {} pixels leaves no room for the surface",
                                            input.view.width, input.view.height),
                                "picture size", "make it larger, or leave the decorations out");
  FrameStatistics stats;
  drawOn(input, target, stats, *std::move(planned));
  return stats;
}

// Uploads pages of the chosen patches, all that are missing for Pages::kAll; only on demand.
void LivePicture::Impl::uploadPages(LivePanels& chosen, FrameInput::Pages pages, FrameStatistics& stats) {
  if (!fields.onDemand()) return;
  PageDemand demand = chosen.demand(submissions.next());
  fields.uploadPages(demand, stats);
  while (pages == FrameInput::Pages::kAll && stats.residency.pages_waiting > 0) {
    submissions.submit({});
    (void)submissions.begin();
    staging.release(submissions.done());
    UploadStatistics more;
    fields.uploadPending(more);
    demand = chosen.demand(submissions.next());
    fields.uploadPages(demand, stats);
  }
}

std::vector<gpu::Quad> LivePicture::Impl::decorationsOf(const FrameInput& input, const PicturePlan& plan,
                                                        std::vector<std::string>& warnings) {
  if (glyphs.used() > Glyphs::kSide / 2) glyphs.clear();
  std::vector<gpu::Quad> quads =
      decorationQuads(plan.layout, input.view, plan.decorations, plan.palette, glyphs, warnings);
  if (input.arrangement == Arrangement::kSplit && plan.panels.size() == 2) {
    const Rectangle right = sideOf(plan.panels[1].plot, input.split, true);
    gpu::Quad line{};
    line.pixels = glm::vec4(right.x - 1, right.y, right.x + 1, right.y + right.height);
    line.colour = glm::vec4(plan.palette.ink, 1.0F);
    line.fill = glm::ivec4(gpu::kFillSolid, 0, 0, 0);
    quads.push_back(line);
  }
  if (input.part) restrictTo(*input.part, quads);
  return quads;
}

DrawnFrame LivePicture::Impl::drawnFrameOf(const std::vector<LivePanel>& panels, const PicturePlan& plan,
                                           const std::vector<gpu::Quad>& decorations) {
  DrawnFrame content;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const LivePanel& panel = panels[i];
    content.panels.push_back({fields.texture(i).version(), panel.uniforms, panel.variant, panel.shade_level,
                              panel.plot, panel.visible, *panel.choice, panel.pages});
  }
  content.decorations = decorations;
  content.ground = plan.palette.ground;
  content.original = fields.original().version();
  content.accepted = fields.shown().accepted;
  return content;
}

void LivePicture::Impl::drawOn(const FrameInput& input, const LiveTarget& target, FrameStatistics& stats,
                               PicturePlan plan) {
  stats.wait_ms = submissions.begin();
  const engine::Stopwatch watch;
  staging.release(submissions.done());
  // Upload what changed, and update the measures by which patches are chosen.
  fields.uploadPending(stats.upload);
  const double upload_ms = watch.ms();

  const engine::Stopwatch selecting;
  const std::optional<std::array<Camera, 2>> head = headCameras(input, plan);
  LivePanels chosen(input, plan, fields, patch_tree_cache, head ? &*head : nullptr);
  uploadPages(chosen, input.pages, stats);
  chosen.finishChoice(stats);
  std::vector<LivePanel>& panels = chosen.panels();
  const std::vector<gpu::Quad> decorations = decorationsOf(input, plan, stats.warnings);
  DrawnFrame current = drawnFrameOf(panels, plan, decorations);

  // A frame can be reused by the next one only at full sharpness and when no heights are pending: tiles of
  // unknown detail are drawn finer than necessary, but correctly; missing pages are part of DrawnFrame.
  const bool stereo = input.stereo.mode != StereoMode::kOff;
  const bool one_eye = !stereo && !head && !input.part;
  const bool every_pixel = input.sharpness == Sharpness::kFull || input.sharpness == Sharpness::kRest;
  const bool with_less = input.sharpness == Sharpness::kHalf || input.sharpness == Sharpness::kQuarter;
  const bool reusable =
      one_eye && every_pixel &&
      stats.upload.pending_tiles == stats.upload.unmeasured_tiles + stats.residency.pages_waiting;
  const bool holds = reusable && input.redraw != FrameInput::Redraw::kAll && frame.holds(target.extent) &&
                     (decorations.empty() || frame.holds(glyphs));
  ShownLayers::Reused reused =
      layers.reuse(holds ? input.redraw : FrameInput::Redraw::kAll, current, chosen, stats);
  stats.select_ms = selecting.ms();

  if (input.sharpness == Sharpness::kFine) rest.reset();  // drawn with the same layers
  const bool whole_frame = stereo || head || input.sharpness != Sharpness::kRest;
  const bool still = !whole_frame && stats.continued && stats.upload.pending_tiles == 0 &&
                     std::ranges::all_of(panels, [](const LivePanel& p) { return empty(p.redraw); });
  if (!whole_frame) stats.rest_left = rest_refused == input.view ? 0 : kRestBands;
  if (stereo || head) {
    frame.forgetTarget();
    stats.changed = {{0, 0, static_cast<int>(target.extent.width), static_cast<int>(target.extent.height)}};
  }
  if (still && stats.rest_left > 0)
    recordRest(input, plan, decorations, target, stats);
  else if (head)
    eyes.recordHead(input.stereo.passes, {panels, {}, plan.palette.ground, input.sharpness}, target);
  else if (stereo)
    eyes.record(input.stereo, {panels, decorations, plan.palette.ground, input.sharpness}, target);
  else
    stats.changed =
        frame.record(submissions, staging, panels, decorations, plan.palette.ground, glyphs, target,
                     reused.redraw, input.sharpness == Sharpness::kRest ? Sharpness::kFull : input.sharpness);
  submissions.submit({target.free,
                      vk::PipelineStageFlagBits2::eCopy | vk::PipelineStageFlagBits2::eColorAttachmentOutput,
                      target.done});
  layers.submitted(std::move(reused), std::move(current),
                   reusable               ? ShownLayers::Holds::kEveryPixel
                   : one_eye && with_less ? ShownLayers::Holds::kFewerPixels
                                          : ShownLayers::Holds::kNothing);
  stats.device_ms = submissions.lastMs();
  stats.range = plan.range;
  stats.contour_step = plan.contour_step;
  stats.vertical_exaggeration = plan.exaggeration;
  stats.pixels_per_mm = plan.panels.front().camera.pixelsPerMm();
  stats.record_ms = watch.ms() - stats.select_ms - upload_ms;
  if (input.part) return;
  seen = SeenFrame{std::move(plan), {}, chosen.eyes(), input.stereo.mode, input.view.width};
  for (const LivePanel& panel : panels) seen->visible.push_back(panel.visible);
}

// The next band, if any is left and its pages are on the device; the picture with four rays per pixel once it is complete.
void LivePicture::Impl::recordRest(const FrameInput& input, const PicturePlan& plan,
                                   const std::vector<gpu::Quad>& decorations, const LiveTarget& target,
                                   FrameStatistics& stats) {
  FrameInput fine = input;
  fine.sharpness = Sharpness::kFine;
  LivePanels chosen(fine, plan, fields, rest_trees);
  FrameStatistics figures;
  uploadPages(chosen, input.pages, figures);
  chosen.finishChoice(figures);
  std::vector<LivePanel>& panels = chosen.panels();
  DrawnFrame now = drawnFrameOf(panels, plan, decorations);
  if (!rest || !frame.holdsRest(target.extent) || !showTheSame(rest->shown, now))
    rest = Rest{std::move(now), 0};
  if (figures.residency.pages_over_budget > 0) rest_refused = input.view;

  LiveFrame::Rest does;
  does.draws = rest->bands < kRestBands && figures.residency.pages_waiting == 0 &&
               figures.residency.pages_over_budget == 0;
  does.first = does.draws && rest->bands == 0;
  std::vector<PatchChoice> parts;
  if (does.draws) {
    CutBands drawn = cutToBands({.first = 0,
                                 .end = input.view.height,
                                 .all = kRestBands,
                                 .next = rest->bands,
                                 .left = kRestBands - rest->bands},
                                chosen.queries(), panels);
    parts = std::move(drawn.parts);
    rest->bands += drawn.bands;
    does.last = rest->bands == kRestBands;
  }
  does.shows = rest->bands == kRestBands;
  stats.changed =
      frame.recordRest(submissions, staging, panels, decorations, plan.palette.ground, glyphs, target, does);
  stats.rests = does.shows;
  stats.rest_left = rest_refused == input.view ? 0 : kRestBands - rest->bands;
}

LivePicture::LivePicture(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LivePicture::~LivePicture() = default;

engine::Result<std::unique_ptr<LivePicture>> LivePicture::create(const LiveOptions& options) {
  auto context = Context::create({options.validation, options.device});
  if (!context) return tl::unexpected(context.error());
  auto glyphs = Glyphs::create();
  if (!glyphs) return tl::unexpected(glyphs.error());
  Context& used = **context;
  const std::string name = used.name();
  const vk::Format format =
      options.colour_format == 0 ? kColourFormat : static_cast<vk::Format>(options.colour_format);
  try {
    return std::unique_ptr<LivePicture>(new LivePicture(std::make_unique<Impl>(
        *std::move(context), used, format, options, *std::move(glyphs), programsOf(used, format))));
  } catch (const std::exception& error) {
    return tl::unexpected(errorOf(name, error.what()));
  }
}

engine::Result<std::unique_ptr<LivePicture>> LivePicture::create(Context& context,
                                                                 std::uint32_t colour_format,
                                                                 const LiveOptions& options) {
  auto glyphs = Glyphs::create();
  if (!glyphs) return tl::unexpected(glyphs.error());
  const auto format = static_cast<vk::Format>(colour_format);
  try {
    return std::unique_ptr<LivePicture>(new LivePicture(std::make_unique<Impl>(
        nullptr, context, format, options, *std::move(glyphs), programsOf(context, format))));
  } catch (const std::exception& error) {
    return tl::unexpected(errorOf(context.name(), error.what()));
  }
}

engine::Result<std::unique_ptr<LivePicture>> LivePicture::createBeside(const LivePicture& other,
                                                                       const LiveOptions& options) {
  const Impl& o = *other.impl_;
  auto glyphs = Glyphs::create();
  if (!glyphs) return tl::unexpected(glyphs.error());
  try {
    return std::unique_ptr<LivePicture>(new LivePicture(std::make_unique<Impl>(
        nullptr, o.context, o.colour_format, options, *std::move(glyphs), o.frame.programs())));
  } catch (const std::exception& error) {
    return tl::unexpected(errorOf(o.context.name(), error.what()));
  }
}

engine::Status LivePicture::update(const Shown& shown) try {
  return impl_->update(shown);
} catch (const std::exception& error) {
  return tl::unexpected(errorOf(impl_->context.name(), error.what()));
}

engine::Status LivePicture::update(const engine::Version& version) {
  Shown next = impl_->fields.shown();
  next.versions = {version};
  next.original.reset();
  return update(next);
}

engine::Result<UploadStatistics> LivePicture::uploadAll(engine::JobControl& job) try {
  UploadStatistics all;
  all.pending_tiles = -1;
  while (all.pending_tiles != 0) {
    if (job.cancelled()) return engine::cancelled();
    (void)impl_->submissions.begin();
    impl_->staging.release(impl_->submissions.done());
    UploadStatistics count;
    impl_->fields.uploadPending(count);
    impl_->submissions.submit({});
    if (all.pending_tiles < 0)
      job.begin("uploading", static_cast<std::uint64_t>(count.pending_tiles));
    else
      job.advance(static_cast<std::uint64_t>(all.pending_tiles - count.pending_tiles));
    all.tiles += count.tiles;
    all.bytes += count.bytes;
    all.changed_samples += count.changed_samples;
    all.ms += count.ms;
    all.pending_tiles = count.pending_tiles;
  }
  return all;
} catch (const std::exception& error) {
  return tl::unexpected(errorOf(impl_->context.name(), error.what()));
}

std::int64_t LivePicture::measureFor(double ms) {
  return impl_->fields.measureFor(ms);
}

engine::Result<FrameStatistics> LivePicture::draw(const FrameInput& input, LiveTarget& target) try {
  FrameInput sized = input;
  sized.part.reset();
  sized.view.width = static_cast<int>(target.extent.width);
  sized.view.height = static_cast<int>(target.extent.height);
  engine::Result<FrameStatistics> stats = impl_->draw(sized, target);
  if (stats) target.changed.insert(target.changed.end(), stats->changed.begin(), stats->changed.end());
  return stats;
} catch (const std::exception& error) {
  return tl::unexpected(errorOf(impl_->context.name(), error.what()));
}

engine::Result<FrameStatistics> LivePicture::drawAndWait(const FrameInput& input) try {
  const engine::Stopwatch watch;
  if (engine::Status ok = checkPart(input); !ok) return tl::unexpected(ok.error());
  const vk::Extent2D extent = extentOf(input);
  const std::uint32_t rays = input.sharpness == Sharpness::kFine ? 2 : 1;
  const std::uint32_t most =
      std::min<std::uint32_t>(kLargestPiece, impl_->context.limits().maxImageDimension2D) / rays;
  if (std::min(input.view.width, input.view.height) < kSmallestPicture ||
      std::max(extent.width, extent.height) > most)
    return engine::inputError(
        fmt::format("a picture of {} x {} pixels in one piece", extent.width, extent.height), "picture size",
        fmt::format("give {} to {} pixels per side", kSmallestPicture, most));
  if (impl_->canvas.image.extent() != extent) {
    impl_->submissions.finish();
    impl_->canvas.image = pictureImage(impl_->context, extent, impl_->colour_format);
    ++impl_->canvas.kept;
  }
  engine::Result<FrameStatistics> stats = impl_->draw(input, impl_->canvas.target());
  if (!stats) return stats;
  impl_->submissions.finish();
  stats->device_ms = impl_->submissions.lastMs();
  stats->wait_ms = watch.ms() - stats->record_ms - stats->select_ms - stats->upload.ms;
  return stats;
} catch (const std::exception& error) {
  return tl::unexpected(errorOf(impl_->context.name(), error.what()));
}

engine::Result<FrameStatistics> LivePicture::draw(const FrameInput& input, Image& out) {
  engine::Result<FrameStatistics> stats = drawAndWait(input);
  if (!stats) return stats;
  try {
    const GpuImage& from = impl_->canvas.image;
    Image image;
    image.width = static_cast<int>(from.extent().width);
    image.height = static_cast<int>(from.extent().height);
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
  return impl_->seen->pick(x, y);
}

std::optional<std::pair<double, double>> LivePicture::pixelOf(int panel, const glm::dvec3& field_mm,
                                                              Eye eye) const {
  if (!impl_->seen) return std::nullopt;
  return impl_->seen->pixelOf(panel, field_mm, eye);
}

std::optional<Grip> LivePicture::grip(double x, double y) const {
  if (!impl_->seen) return std::nullopt;
  return impl_->seen->grip(x, y);
}

std::optional<Framing> LivePicture::framing() const {
  if (!impl_->seen) return std::nullopt;
  return impl_->seen->plan.panels.front().framing;
}

void LivePicture::refreshRanges() {
  impl_->spans.reset();
}

void LivePicture::refreshColours() {
  impl_->colours_outdated = true;
}

void LivePicture::finish() {
  try {
    impl_->submissions.finish();
  } catch (const vk::SystemError&) {
    // A lost device has no work in progress.
  }
}

bool LivePicture::prepareNextOf(const LivePicture& rehearsed) noexcept try {
  for (const Pipelines::Kind& kind : rehearsed.impl_->frame.programs()->pipelines().kinds())
    if (impl_->frame.programs()->pipelines().prepare(kind)) return true;
  return false;
} catch (const std::exception&) {
  // A lost device, or one without memory: the frame that needs it reports that.
  return false;
}

const std::string& LivePicture::device() const noexcept {
  return impl_->context.name();
}

std::vector<std::string> LivePicture::validationMessages() const {
  return impl_->context.messages().all();
}

}  // namespace fettle::render
