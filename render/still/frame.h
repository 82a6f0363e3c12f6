#pragma once

#include <span>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "render/plan/glyphs.h"
#include "render/plan/plan.h"
#include "render/residency/field_texture.h"
#include "render/vulkan/pipelines.h"
#include "render/vulkan/target.h"

namespace fettle::render {

/// A surface of a plan with the textures it is drawn from.
struct PanelDraw {
  const PanelPlan* panel = nullptr;
  const FieldTexture* field = nullptr;
  const FieldTexture* original = nullptr;  ///< of the deviation; null for heights
};

struct FrameOptions {
  int samples_per_side = 1;
  MarksOverlay marks = MarksOverlay::kHide;
  Contours contours = Contours::kHide;
  double piece_ms = 50.0;  ///< as RendererOptions::piece_ms
};

/// Draws one picture: every panel into a scene target, then all of it into the picture. Keeps what the next
/// frame of the same size can use again. The target decides whether that is a window or memory.
///
/// Threading: as Context. Throws vk::SystemError.
class Frame {
 public:
  explicit Frame(Context& context) : context_(context), pipelines_(context) {}

  /// Returns when the picture is in `target`. Milliseconds of recording, drawing and waiting. Draws in
  /// pieces (render/vulkan/pieces.h), each a submission that is waited for; `job` advances with every one.
  /// Errors: kCancelled, between two pieces; nothing is under way then.
  engine::Result<double> draw(const PicturePlan& plan, std::span<const PanelDraw> panels,
                              const std::vector<gpu::Quad>& furniture, const FrameOptions& options,
                              const Glyphs& glyphs, const PictureTarget& target, engine::JobControl& job);

  [[nodiscard]] const Pipelines& pipelines() const noexcept { return pipelines_; }

 private:
  void bringGlyphs(const Glyphs& glyphs);

  Context& context_;
  Pipelines pipelines_;
  std::vector<SceneTarget> scenes_;
  GpuImage glyphs_;
  std::uint64_t glyph_generation_ = 0;
};

}  // namespace fettle::render
