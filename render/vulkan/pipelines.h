#pragma once

#include <compare>
#include <map>
#include <span>
#include <utility>

#include "render/vulkan/context.h"
#include "render/vulkan/memory.h"

namespace fettle::render {

/// The features of the surface that a picture uses: each combination is a pipeline of its own, so that unused
/// features are not in its code (specialisation constants).
struct SurfaceVariant {
  bool paged = false;
  bool marks = false;
  bool deviation = false;
  bool contours = false;
  bool smooth = false;
  bool holes = true;
  bool cell_slopes = false;
  bool on_demand = false;    ///< pages on the device on demand (render/residency/page_demand.h)
  bool gather = false;       ///< see shaders/layout.h
  bool perspective = false;  ///< used by shade() only
  bool footprint = false;    ///< used by shade() only
  bool occlusion = false;    ///< used by shade() only
  bool cavity = false;       ///< used by shade() only
  bool material = false;     ///< used by shade() only
  // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy 14 reads the zero of a comparison as a pointer
  friend auto operator<=>(const SurfaceVariant&, const SurfaceVariant&) = default;
};

/// The pipelines, created on first use and kept. Throws vk::SystemError.
class Pipelines {
 public:
  enum class Views {
    kOne,
    kBoth,  ///< passes draw for both eyes at once, to two layers; not without multiview
  };
  /// For pictures of this format.
  explicit Pipelines(const Context& context, vk::Format colour = kColourFormat, Views views = Views::kOne);

  enum class Paged { kNo, kYes, kByNeed };
  enum class Holes { kNo, kYes };  ///< whether some cells are left out
  [[nodiscard]] vk::Pipeline wall(Paged paged, Holes holes = Holes::kYes);
  /// Depth of the surface only: of patches, and of the seams between them.
  struct Geometry {
    enum class Kind { kPatches, kSeams } kind = Kind::kPatches;
    Paged paged = Paged::kNo;
    Holes holes = Holes::kNo;
    // NOLINTNEXTLINE(modernize-use-nullptr): as above
    friend auto operator<=>(const Geometry&, const Geometry&) = default;
  };
  [[nodiscard]] vk::Pipeline depth(const Geometry& geometry);
  /// Shades a plot from that depth, once per pixel: colour only.
  [[nodiscard]] vk::Pipeline shade(const SurfaceVariant& variant);
  [[nodiscard]] vk::Pipeline floor();
  enum class Lines { kOnTop, kInScene };
  [[nodiscard]] vk::Pipeline lines(Lines depth);
  /// Its shadow; what the surface hides of it, faintly; what it does not. They do not write depth.
  enum class Stylus { kShadow, kHidden, kSeen };
  [[nodiscard]] vk::Pipeline stylus(Stylus pass);
  [[nodiscard]] vk::Pipeline quads();

  /// Layouts of the surface's and the picture's set 0 and pipelines (shaders/layout.h names the bindings).
  [[nodiscard]] vk::PipelineLayout sceneLayout() const noexcept { return *scene_layout_; }
  [[nodiscard]] vk::DescriptorSetLayout sceneSet() const noexcept { return *scene_set_; }
  [[nodiscard]] vk::PipelineLayout pictureLayout() const noexcept { return *picture_layout_; }
  [[nodiscard]] vk::DescriptorSetLayout pictureSet() const noexcept { return *picture_set_; }
  /// Number of pipelines: pictures without an option create none for it.
  [[nodiscard]] std::size_t made() const noexcept { return made_; }

 private:
  struct Recipe;
  using Words = std::span<const std::uint32_t>;
  [[nodiscard]] Words one(Words for_one, Words for_both) const noexcept;
  [[nodiscard]] vk::raii::Pipeline make(const Recipe& recipe);

  const Context& context_;
  vk::Format colour_;
  Views views_;
  vk::raii::Sampler nearest_ = nullptr;
  vk::raii::DescriptorSetLayout scene_set_ = nullptr, picture_set_ = nullptr;
  vk::raii::PipelineLayout scene_layout_ = nullptr, picture_layout_ = nullptr;
  std::map<SurfaceVariant, vk::raii::Pipeline> shades_;
  std::map<Geometry, vk::raii::Pipeline> depths_;
  std::map<std::pair<Paged, Holes>, vk::raii::Pipeline> walls_;
  std::map<Lines, vk::raii::Pipeline> lines_;
  std::map<Stylus, vk::raii::Pipeline> styli_;
  vk::raii::Pipeline floor_ = nullptr, quads_ = nullptr;
  std::size_t made_ = 0;
};

}  // namespace fettle::render
