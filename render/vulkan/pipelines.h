#pragma once

#include <compare>
#include <map>
#include <mutex>
#include <span>
#include <variant>
#include <vector>

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
///
/// Threading: as Context, but for kinds() and prepare(), which any thread may call meanwhile.
class Pipelines {
 public:
  enum class Views {
    kOne,
    kBoth,  ///< passes draw for both eyes at once, to two layers; not without multiview
  };
  enum class Paged { kNo, kYes, kByNeed };
  enum class Holes { kNo, kYes };  ///< whether some cells are left out
  /// Depth of the surface only: of patches, and of the seams between them.
  struct Geometry {
    enum class Kind { kPatches, kSeams } kind = Kind::kPatches;
    Paged paged = Paged::kNo;
    Holes holes = Holes::kNo;
    // NOLINTNEXTLINE(modernize-use-nullptr): as above
    friend auto operator<=>(const Geometry&, const Geometry&) = default;
  };
  /// Colour and depth of the sides of the block.
  struct Wall {
    Paged paged = Paged::kNo;
    Holes holes = Holes::kYes;
    // NOLINTNEXTLINE(modernize-use-nullptr): as above
    friend auto operator<=>(const Wall&, const Wall&) = default;
  };
  enum class Lines { kOnTop, kInScene };
  /// Its shadow; what the surface hides of it, faintly; what it does not. They do not write depth.
  enum class Stylus { kShadow, kHidden, kSeen };
  enum class Flat {
    kFloor,  ///< the plate below the field
    kQuads,  ///< text and bars
  };
  /// What one of them draws. A SurfaceVariant shades a plot from the depth, once per pixel: colour only.
  using Kind = std::variant<Geometry, SurfaceVariant, Wall, Lines, Stylus, Flat>;

  /// For pictures of this format.
  explicit Pipelines(const Context& context, vk::Format colour = kColourFormat, Views views = Views::kOne);

  [[nodiscard]] vk::Pipeline of(const Kind& kind);
  /// What was drawn so far: what another picture of these things is going to need.
  [[nodiscard]] std::vector<Kind> kinds() const;
  /// Makes it where it is missing, which takes tens of milliseconds on a processor; whether it was.
  bool prepare(const Kind& kind);

  /// Layouts of the surface's and the picture's set 0 and pipelines (shaders/layout.h names the bindings).
  [[nodiscard]] vk::PipelineLayout sceneLayout() const noexcept { return *scene_layout_; }
  [[nodiscard]] vk::DescriptorSetLayout sceneSet() const noexcept { return *scene_set_; }
  [[nodiscard]] vk::PipelineLayout pictureLayout() const noexcept { return *picture_layout_; }
  [[nodiscard]] vk::DescriptorSetLayout pictureSet() const noexcept { return *picture_set_; }

 private:
  struct Recipe;
  using Words = std::span<const std::uint32_t>;
  [[nodiscard]] Words one(Words for_one, Words for_both) const noexcept;
  [[nodiscard]] Recipe recipeOf(const Geometry& geometry) const;
  [[nodiscard]] Recipe recipeOf(const SurfaceVariant& variant) const;
  [[nodiscard]] Recipe recipeOf(const Wall& wall) const;
  [[nodiscard]] Recipe recipeOf(Lines depth) const;
  [[nodiscard]] Recipe recipeOf(Stylus pass) const;
  [[nodiscard]] Recipe recipeOf(Flat what) const;
  [[nodiscard]] vk::raii::Pipeline make(const Recipe& recipe) const;
  [[nodiscard]] vk::Pipeline found(const Kind& kind) const;

  const Context& context_;
  vk::Format colour_;
  Views views_;
  vk::raii::Sampler nearest_ = nullptr;
  vk::raii::DescriptorSetLayout scene_set_ = nullptr, picture_set_ = nullptr;
  vk::raii::PipelineLayout scene_layout_ = nullptr, picture_layout_ = nullptr;
  mutable std::mutex mutex_;  // of what follows; no pipeline is made under it
  std::map<Kind, vk::raii::Pipeline> made_;
};

}  // namespace fettle::render
