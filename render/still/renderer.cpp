#include <algorithm>
#include <array>
#include <chrono>
#include <new>

#include <fmt/format.h>

#include "render/plan/picture.h"
#include "render/still/frame.h"
#include "render/vulkan/capture.h"

namespace fettle::render {
namespace {

// Turns what Vulkan throws into the room's errors.
engine::Error errorOf(const std::string& device, const char* what) {
  return engine::failure(fmt::format("drawing failed ({})", what), device, "try a smaller picture or field")
      .value();
}

}  // namespace

struct Renderer::Impl {
  std::unique_ptr<Context> context;
  Glyphs glyphs;
  std::unique_ptr<Frame> frame;
  PictureTarget target;
  // What the device holds: left, right, and what deviations are counted from.
  std::array<FieldTexture, 3> textures;
  std::uint32_t max_side = 0;
  double piece_ms = 50.0;

  Impl(std::unique_ptr<Context> c, Glyphs g)
      : context(std::move(c)), glyphs(std::move(g)), frame(std::make_unique<Frame>(*context)) {}

  // The texture for a version: one that already shows it, else the role's own. `taken` are in use this frame.
  engine::Result<FieldTexture*> bring(const engine::Version& version, std::size_t role,
                                      FieldTexture::Marks marks, std::array<bool, 3>& taken,
                                      UploadCount& count, engine::JobControl& job) {
    std::size_t slot = textures.size();
    for (std::size_t i = 0; i < textures.size(); ++i)
      if (!textures[i].version().empty() && textures[i].version() == version) slot = std::min(slot, i);
    // A slot that another role uses this frame with the very same version is shared; one whose old content
    // happens to fit is used instead of uploading the version a second time.
    if (slot == textures.size()) slot = role;
    for (std::size_t i = 0; taken[slot] && !(textures[slot].version() == version) && i < textures.size(); ++i)
      if (!taken[i]) slot = i;
    taken[slot] = true;
    const engine::Result<UploadCount> done = textures[slot].update(*context, version, marks, max_side, job);
    if (!done) return tl::unexpected(done.error());
    count.tiles += done->tiles;
    count.bytes += done->bytes;
    return &textures[slot];
  }

  engine::Result<PictureReport> render(const PictureSpec& spec, Image& out, engine::JobControl& job);
};

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::~Renderer() = default;

const std::string& Renderer::device() const noexcept {
  return impl_->context->name();
}

engine::Result<std::unique_ptr<Renderer>> Renderer::create(const RendererOptions& options) {
  engine::Result<std::unique_ptr<Context>> context = Context::create(options);
  if (!context) return tl::unexpected(context.error());
  engine::Result<Glyphs> glyphs = Glyphs::create();
  if (!glyphs) return tl::unexpected(glyphs.error());
  const std::string name = (*context)->name();
  try {
    auto impl = std::make_unique<Impl>(std::move(*context), std::move(*glyphs));
    impl->max_side = impl->context->limits().maxImageDimension2D;
    if (options.max_image_side > 0)
      impl->max_side =
          std::min(impl->max_side, static_cast<std::uint32_t>(std::max(64, options.max_image_side)));
    impl->piece_ms = options.piece_ms;
    return std::unique_ptr<Renderer>(new Renderer(std::move(impl)));
  } catch (const std::exception& error) {
    return tl::unexpected(errorOf(name, error.what()));
  }
}

engine::Result<PictureReport> Renderer::render(const PictureSpec& spec, Image& out, engine::JobControl& job) {
  try {
    return impl_->render(spec, out, job);
  } catch (const std::exception& error) {
    // Half-done uploads must not be taken for the version they were to become.
    for (FieldTexture& texture : impl_->textures) texture.clear();
    return tl::unexpected(errorOf(impl_->context->name(), error.what()));
  }
}

engine::Result<PictureReport> Renderer::Impl::render(const PictureSpec& spec, Image& out,
                                                     engine::JobControl& job) {
  engine::Result<PicturePlan> plan = planPicture(spec);
  if (!plan) return tl::unexpected(plan.error());
  PictureReport report;
  report.width = spec.view.width;
  report.height = spec.view.height;
  report.device = context->name();
  report.range = plan->range;
  report.vertical_exaggeration = plan->exaggeration;

  const auto marks =
      spec.marks == MarksOverlay::kShow ? FieldTexture::Marks::kBring : FieldTexture::Marks::kLeave;
  const auto upload_start = std::chrono::steady_clock::now();
  UploadCount count;
  std::array<bool, 3> taken{};
  std::vector<PanelDraw> panels;
  const FieldTexture* original = nullptr;
  // First what the panels show, then the original, which may turn out to be one of them.
  for (std::size_t i = 0; i < plan->panels.size(); ++i) {
    const engine::Result<FieldTexture*> texture = bring(plan->panels[i].field, i, marks, taken, count, job);
    if (!texture) return tl::unexpected(texture.error());
    panels.push_back({&plan->panels[i], *texture, nullptr});
  }
  if (spec.deviation_from) {
    const engine::Result<FieldTexture*> texture =
        bring(*spec.deviation_from, 2, FieldTexture::Marks::kLeave, taken, count, job);
    if (!texture) return tl::unexpected(texture.error());
    original = *texture;
  }
  for (PanelDraw& panel : panels) panel.original = original;
  report.upload_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - upload_start).count();
  report.tiles_uploaded = count.tiles;
  report.bytes_uploaded = count.bytes;
  for (const PanelPlan& panel : plan->panels) {
    report.patches += static_cast<std::int64_t>(panel.detail.patches.size());
    report.vertices += static_cast<std::int64_t>(panel.detail.patches.size()) * gpu::kPatchVertices +
                       static_cast<std::int64_t>(panel.detail.walls.size()) * gpu::kWallVertices;
  }

  if (job.cancelled()) return engine::cancelled();
  if (glyphs.used() > Glyphs::kSide / 2) glyphs.clear();
  const std::vector<gpu::Quad> furniture =
      furnish(plan->layout, spec.view, plan->furniture, plan->palette, glyphs, report.warnings);
  const vk::Extent2D extent{static_cast<std::uint32_t>(spec.view.width),
                            static_cast<std::uint32_t>(spec.view.height)};
  if (target.colour.extent() != extent) target = PictureTarget(*context, extent);
  const FrameOptions options{spec.samples_per_side, spec.marks, spec.contours, piece_ms};
  const engine::Result<double> frame_ms = frame->draw(*plan, panels, furniture, options, glyphs, target, job);
  if (!frame_ms) return tl::unexpected(frame_ms.error());
  report.frame_ms = *frame_ms;
  if (job.cancelled()) return engine::cancelled();
  const auto read_start = std::chrono::steady_clock::now();
  Image picture = capture(*context, target);
  if (job.cancelled()) return engine::cancelled();
  out = std::move(picture);
  report.read_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - read_start).count();
  report.validation_messages = context->messages().all();
  return report;
}

}  // namespace fettle::render
