#pragma once

#include <array>
#include <map>

#include "render/plan/stereo.h"
#include "render/vulkan/live_target.h"
#include "render/vulkan/memory.h"
#include "render/vulkan/submissions.h"

namespace fettle::render {

/// The pictures of the two eyes, and the pass that combines them into one.
///
/// Threading: as Context. Throws vk::SystemError.
class StereoCompose {
 public:
  /// Draws to targets of this format, from eyes' pictures of the same.
  StereoCompose(Context& context, vk::Format colour);

  enum class Layers {
    kOneImage,   ///< the eyes are the two layers of one image, drawn in one pass
    kTwoImages,  ///< each has an image of its own
  };
  /// Pixels of one eye's picture in a picture of `whole`.
  [[nodiscard]] static vk::Extent2D eyeExtent(StereoMode mode, vk::Extent2D whole) noexcept;
  /// Before the eyes are drawn: creates their images, and makes this submission wait until those of the last
  /// one were read.
  void begin(Submissions& submissions, vk::Extent2D eye, Layers layers);
  /// The target of an eye; of both eyes for kOneImage, as a view of two layers. Left as a source of copies.
  [[nodiscard]] LiveTarget target(Eye eye) const;
  /// After the eyes are drawn: draws both into `target`, then what LiveTarget::over draws.
  void record(const vk::raii::CommandBuffer& commands, StereoMode mode, const LiveTarget& target);
  /// In place of record(): copies each eye's picture (kTwoImages) into its layer of `target`.
  void copyToLayers(const vk::raii::CommandBuffer& commands, const LiveTarget& target) const;

 private:
  [[nodiscard]] vk::Pipeline pipeline(StereoMode mode);

  Context& context_;
  vk::Format colour_;
  vk::raii::DescriptorSetLayout set_layout_ = nullptr;
  vk::raii::PipelineLayout layout_ = nullptr;
  vk::raii::DescriptorPool pool_ = nullptr;
  vk::raii::DescriptorSet set_ = nullptr;
  std::map<StereoMode, vk::raii::Pipeline> pipelines_;
  Layers layers_ = Layers::kTwoImages;
  std::array<GpuImage, 2> images_;                              // only the first for kOneImage
  std::array<vk::raii::ImageView, 2> views_{nullptr, nullptr};  // of each eye
};

}  // namespace fettle::render
