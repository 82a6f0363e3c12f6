#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "render/config.h"
#include "render/live/glyph_image.h"
#include "render/live/live_panel.h"
#include "render/live/live_picture.h"
#include "render/live/live_programs.h"
#include "render/live/resize.h"
#include "render/live/stylus_pass.h"
#include "render/plan/glyphs.h"
#include "render/plan/places.h"
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
  [[nodiscard]] bool holds(vk::Extent2D extent) const noexcept { return whole_.extent == extent; }
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
  [[nodiscard]] bool holdsRest(vk::Extent2D extent) const noexcept { return rest_extent_ == extent; }
  /// Records a frame in which nothing of the surface changed since the one of kFull that the layers hold. `panels`: as for kFine.
  std::vector<Rectangle> recordRest(Submissions& submissions, StagingRing& staging,
                                    std::span<const LivePanel> panels,
                                    const std::vector<gpu::Quad>& decorations, const glm::vec3& ground,
                                    const Glyphs& glyphs, const LiveTarget& target, const Rest& rest);

  /// Something else is drawn to the target.
  void forgetTarget() noexcept { held_.reset(); }

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
  // The images that the surface is drawn to.
  struct Layers {
    vk::Extent2D extent;  // of their picture
    float scale = 1.0F;   // their pixels per pixel of that picture
    GpuImage depth, base;
  };
  void makeLayers(Submissions& submissions, vk::Extent2D extent, Sharpness sharpness);
  // `under_stylus`: depth of the surface over which the stylus is drawn.
  void fill(Slot& slot, std::span<const LivePanel> panels, const std::vector<gpu::Quad>& decorations,
            const Layers& layers, const GpuImage& under_stylus);
  void recordDepth(const vk::raii::CommandBuffer& commands, const Slot& slot,
                   std::span<const LivePanel> panels, const Layers& layers, Redraw redraw);
  enum class HiddenLines : std::uint8_t { kInBase, kOverCopy };
  void recordBase(const vk::raii::CommandBuffer& commands, const Slot& slot,
                  std::span<const LivePanel> panels, const glm::vec3& ground, const Layers& layers,
                  Redraw redraw, HiddenLines lines);
  /// What the frame before has done to the layers that a surface is drawn to.
  struct Before {
    Barriers::Access base;  ///< how it used `base` last
    HiddenLines lines = HiddenLines::kOverCopy;
  };
  void recordSurface(const vk::raii::CommandBuffer& commands, const Slot& slot,
                     std::span<const LivePanel> panels, const glm::vec3& ground, const Layers& layers,
                     Redraw redraw, const Before& before);
  void recordLines(const vk::raii::CommandBuffer& commands, const Slot& slot,
                   std::span<const LivePanel> panels, Pipelines::Lines depth, float scale);
  void recordDecorations(const vk::raii::CommandBuffer& commands, const Slot& slot,
                         std::span<const LivePanel> panels, const std::vector<gpu::Quad>& decorations,
                         const GpuImage& base, Redraw redraw);
  [[nodiscard]] GpuImage baseOf(vk::Extent2D extent) const;
  void makeLayer(Layers& layers, vk::Extent2D picture, vk::Extent2D size);
  void makeRest(Submissions& submissions, vk::Extent2D extent);
  void makeFine(vk::Extent2D extent);
  void makeSmall(Layers& layers, vk::Extent2D picture, Resize::Times times, std::unique_ptr<Resize>& enlarge);
  static void beforeResize(const vk::raii::CommandBuffer& commands, const Layers& layers, const GpuImage& to);
  void recordEnlarged(const vk::raii::CommandBuffer& commands, const Layers& layers,
                      std::span<const LivePanel> panels, const glm::vec3& ground);
  void recordReduced(const vk::raii::CommandBuffer& commands, const Resize& reduce, const GpuImage& to);
  /// What is copied from a base to a target: all of it, or these places.
  struct Copied {
    const GpuImage& base;
    std::vector<Rectangle> places;
    bool over_before = false;  // the target holds the frame before
  };
  /// `changed`: of the base since the frame before; nothing: all of it.
  Copied copiedTo(const LiveTarget& target, const GpuImage& base, std::span<const LivePanel> panels,
                  std::optional<Places> changed);
  void recordTarget(const vk::raii::CommandBuffer& commands, const Slot& slot,
                    std::span<const LivePanel> panels, const Copied& copied, const LiveTarget& target,
                    Sharpness sharpness);

  Context& context_;
  vk::Format colour_;
  std::uint32_t layers_;     // of depth_, base_ and targets
  std::uint32_t view_mask_;  // 0: there is one
  std::shared_ptr<LivePrograms> programs_;
  Pipelines& pipelines_;  // of them
  StylusPass stylus_;     // draws with those
  vk::raii::DescriptorPool pool_ = nullptr;
  std::array<Slot, Submissions::kInFlight> slots_;
  Buffer no_pages_;  // bound where the shader reads no pages
  vk::raii::BufferView no_pages_view_ = nullptr;
  Layers whole_, half_, quarter_, fine_;  // all but whole_ are created on first use
  std::unique_ptr<Resize> enlarge_, enlarge_more_, reduce_;
  GpuImage rest_;  // of recordRest, as whole_.base; created on first use
  vk::Extent2D rest_extent_;
  std::unique_ptr<Resize> reduce_to_rest_;
  GlyphImage glyphs_;
  // The target that holds the last frame.
  struct Held {
    std::uint64_t kept = 0;
    vk::Image image;
    vk::Extent2D extent;
    const GpuImage* base = nullptr;
    std::vector<Rectangle> overlays;
  };
  std::optional<Held> held_;
};

}  // namespace fettle::render
