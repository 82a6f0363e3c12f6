#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "render/config.h"
#include "render/live/frame_layers.h"
#include "render/live/glyph_image.h"
#include "render/live/kept_target.h"
#include "render/live/live_panel.h"
#include "render/live/live_picture.h"
#include "render/live/live_programs.h"
#include "render/live/stylus_pass.h"
#include "render/plan/glyphs.h"
#include "render/plan/plan.h"
#include "render/residency/live_texture.h"
#include "render/vulkan/barrier.h"
#include "render/vulkan/live_target.h"
#include "render/vulkan/pipelines.h"
#include "render/vulkan/submissions.h"

namespace fettle::render {

/// Records a frame in three layers, each of which is reused while nothing in it changes:
///
///   depth   of the surface, its seams, rim walls and plate: geometry, drawn without a colour
///   base    the surface shaded from that depth, once per pixel (shaders/shade.frag); then what is shaded
///           triangle by triangle, plate and walls; then the decorations
///   target  a copy of base; then overlay lines, the stylus between those that the surface hides and those on
///           top; then what LiveTarget::over draws
///
/// At Sharpness::kHalf, kQuarter and kFine, depth, shading and the lines hidden by the surface use layers of half, a
/// quarter of or twice the size in each direction; base is those enlarged or reduced, then the decorations as usual.
///
/// At kRest (recordRest) fine layers are filled part by part, and their reduction is a base of its own, so that what kFull has
/// drawn stays.
///
/// A second eye (stereo) is a second layer of depth and base and a second element of
/// PanelUniforms::views; the passes are the same, drawn with a view mask.
///
/// Resources that a frame in flight reads are kept until its slot is used again.
///
/// Threading: as Context. Throws vk::SystemError.
class LiveFrame {
 public:
  /// kBoth: targets have two layers, one for each eye of PanelUniforms::views. `programs` are for such pictures of this format.
  LiveFrame(Context& context, vk::Format colour, Pipelines::Views views,
            std::shared_ptr<LivePrograms> programs);

  /// Whether the layers hold a picture of full sharpness in this size, and whether decorations would be drawn
  /// with the same glyph image.
  [[nodiscard]] bool holds(vk::Extent2D extent) const noexcept { return layers_.holds(extent); }
  [[nodiscard]] bool holds(const Glyphs& glyphs) const noexcept { return glyphs_.holds(glyphs); }
  enum class Redraw {
    kAll,  ///< every layer, whatever LivePanel::redraw says
    kParts,  ///< of depth and base only LivePanel::redraw; the rest stays as it is. Only at kFull, after a frame of kFull
    kFirstPart,  ///< only LivePanel::redraw, the rest becomes empty. Only by recordRest
    kFirstPartOver,  ///< the same of depth; of base the rest stays as it is. Only at kFull, after a frame of kHalf or kQuarter
  };
  /// Records into submissions.commands(). `staging` transfers new glyphs. Returns the places of the target that are written, disjoint.
  std::vector<Rectangle> record(Submissions& submissions, StagingRing& staging,
                                std::span<const LivePanel> panels, const std::vector<gpu::Quad>& decorations,
                                const glm::vec3& ground, const Glyphs& glyphs, const LiveTarget& target,
                                Redraw redraw, Sharpness sharpness);

  /// What a frame at rest does to the picture with four rays per pixel, which has layers of its own.
  struct Rest {
    bool draws = false;                ///< LivePanel::redraw of each panel
    bool first = false, last = false;  ///< of the frames that draw it
    bool shows = false;                ///< it, complete, instead of the picture of kFull
  };
  /// Whether its layers are of this size.
  [[nodiscard]] bool holdsRest(vk::Extent2D extent) const noexcept { return layers_.holdsRest(extent); }
  /// Records a frame in which nothing of the surface changed since the one of kFull that the layers hold. `panels`: as for kFine.
  std::vector<Rectangle> recordRest(Submissions& submissions, StagingRing& staging,
                                    std::span<const LivePanel> panels,
                                    const std::vector<gpu::Quad>& decorations, const glm::vec3& ground,
                                    const Glyphs& glyphs, const LiveTarget& target, const Rest& rest);

  /// Something else is drawn to the target.
  void forgetTarget() noexcept { kept_.forget(); }

  [[nodiscard]] const std::shared_ptr<LivePrograms>& programs() const noexcept { return programs_; }

 private:
  struct PanelSets {
    vk::raii::DescriptorSet surface = nullptr, seams = nullptr, walls = nullptr, in_scene = nullptr,
                            on_top = nullptr, stylus = nullptr;
    vk::raii::BufferView pages = nullptr;  // of the arena
  };
  struct Slot {
    Buffer arena;
    std::array<PanelSets, kMostPanels> panels;
    vk::raii::DescriptorSet picture = nullptr;
    [[nodiscard]] std::array<vk::DescriptorSet, kMostPanels> styluses() const;
  };
  using Surface = FrameLayers::Surface;
  // `under_stylus`: depth of the surface over which the stylus is drawn.
  void fill(Slot& slot, std::span<const LivePanel> panels, const std::vector<gpu::Quad>& decorations,
            const Surface& surface, const GpuImage& under_stylus);
  void recordDepth(const vk::raii::CommandBuffer& commands, const Slot& slot,
                   std::span<const LivePanel> panels, const Surface& surface, Redraw redraw);
  enum class HiddenLines : std::uint8_t { kInBase, kOverCopy };
  void recordBase(const vk::raii::CommandBuffer& commands, const Slot& slot,
                  std::span<const LivePanel> panels, const glm::vec3& ground, const Surface& surface,
                  Redraw redraw, HiddenLines lines);
  /// What the frame before has done to the layers that a surface is drawn to.
  struct Before {
    Barriers::Access base;  ///< how it used `base` last
    HiddenLines lines = HiddenLines::kOverCopy;
  };
  void recordSurface(const vk::raii::CommandBuffer& commands, const Slot& slot,
                     std::span<const LivePanel> panels, const glm::vec3& ground, const Surface& surface,
                     Redraw redraw, const Before& before);
  void recordLines(const vk::raii::CommandBuffer& commands, const Slot& slot,
                   std::span<const LivePanel> panels, Pipelines::Lines depth, float scale);
  void recordDecorations(const vk::raii::CommandBuffer& commands, const Slot& slot,
                         std::span<const LivePanel> panels, const std::vector<gpu::Quad>& decorations,
                         const GpuImage& base, Redraw redraw);
  void recordTarget(const vk::raii::CommandBuffer& commands, const Slot& slot,
                    std::span<const LivePanel> panels, const BaseCopy& copied, const LiveTarget& target,
                    Sharpness sharpness);

  Context& context_;
  std::uint32_t eyes_;       // layers of images and targets
  std::uint32_t view_mask_;  // 0: there is one
  std::shared_ptr<LivePrograms> programs_;
  Pipelines& pipelines_;  // of them
  StylusPass stylus_;     // draws with those
  vk::raii::DescriptorPool pool_ = nullptr;
  std::array<Slot, Submissions::kInFlight> slots_;
  Buffer no_pages_;  // bound where the shader reads no pages
  vk::raii::BufferView no_pages_view_ = nullptr;
  FrameLayers layers_;
  GlyphImage glyphs_;
  KeptTarget kept_;
};

}  // namespace fettle::render
