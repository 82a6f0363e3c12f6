#pragma once

#include <compare>
#include <map>

#include "render/target.h"

namespace fettle::render {

/// What of the surface a picture uses: each combination is a pipeline of its own, so that what is left out is
/// not in its code (specialisation constants).
struct SurfaceVariant {
  bool paged = false;
  bool marks = false;
  bool deviation = false;
  bool contours = false;
  bool smooth = false;
  bool holes = true;
  bool cell_slopes = false;
  bool by_need = false;  ///< pages on the device by need (render/page_demand.h)
  friend auto operator<=>(const SurfaceVariant&, const SurfaceVariant&) = default;
};

/// The pipelines, made when first asked for and kept. Throws vk::SystemError.
class Pipelines {
 public:
  /// For pictures of this format.
  explicit Pipelines(const Context& context, vk::Format colour = kColourFormat);

  [[nodiscard]] vk::Pipeline surface(const SurfaceVariant& variant);
  enum class Paged { kNo, kYes, kByNeed };
  [[nodiscard]] vk::Pipeline wall(Paged paged);
  [[nodiscard]] vk::Pipeline seam(const SurfaceVariant& variant);
  [[nodiscard]] vk::Pipeline floor();
  enum class Lines { kOnTop, kInScene };
  [[nodiscard]] vk::Pipeline lines(Lines depth);
  [[nodiscard]] vk::Pipeline quads();

  /// Layouts of the surface's and the picture's set 0 and pipelines (shaders/layout.h names the bindings).
  [[nodiscard]] vk::PipelineLayout sceneLayout() const noexcept { return *scene_layout_; }
  [[nodiscard]] vk::DescriptorSetLayout sceneSet() const noexcept { return *scene_set_; }
  [[nodiscard]] vk::PipelineLayout pictureLayout() const noexcept { return *picture_layout_; }
  [[nodiscard]] vk::DescriptorSetLayout pictureSet() const noexcept { return *picture_set_; }
  /// How many pipelines exist: pictures that leave an option out make none for it.
  [[nodiscard]] std::size_t made() const noexcept { return made_; }

 private:
  struct Recipe;
  [[nodiscard]] vk::raii::Pipeline make(const Recipe& recipe);

  const Context& context_;
  vk::Format colour_;
  vk::raii::DescriptorSetLayout scene_set_ = nullptr, picture_set_ = nullptr;
  vk::raii::PipelineLayout scene_layout_ = nullptr, picture_layout_ = nullptr;
  std::map<SurfaceVariant, vk::raii::Pipeline> surfaces_, seams_;
  std::map<Paged, vk::raii::Pipeline> walls_;
  std::map<Lines, vk::raii::Pipeline> lines_;
  vk::raii::Pipeline floor_ = nullptr, quads_ = nullptr;
  std::size_t made_ = 0;
};

}  // namespace fettle::render
