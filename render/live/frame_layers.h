#pragma once

#include <memory>
#include <span>

#include "render/live/live_panel.h"
#include "render/live/live_picture.h"
#include "render/live/live_programs.h"
#include "render/live/resize.h"
#include "render/vulkan/memory.h"
#include "render/vulkan/submissions.h"

namespace fettle::render {

/// The images that LiveFrame draws a surface to, of every sharpness, and what makes a base of the picture's size of them. All but
/// those of every pixel are made on first use.
///
/// Threading: as Context. Throws vk::SystemError.
class FrameLayers {
 public:
  struct Surface {
    vk::Extent2D picture;  ///< whose surface it is
    float scale = 1.0F;    ///< pixels of the images per pixel of that picture
    GpuImage depth, base;
  };
  /// `count`: layers of each image, one for each eye.
  FrameLayers(Context& context, vk::Format colour, std::uint32_t count, LivePrograms& programs) noexcept
      : context_(context), colour_(colour), count_(count), programs_(programs) {}

  /// Makes what a frame of this sharpness needs, kRest excepted. Waits for frames in flight when something is made.
  void prepare(Submissions& submissions, vk::Extent2D picture, Sharpness sharpness);
  /// The same for frames of kRest, after one of kFull of this picture was prepared.
  void prepareRest(Submissions& submissions, vk::Extent2D picture);

  /// With every pixel; other surfaces are resized into its base.
  [[nodiscard]] const Surface& whole() const noexcept { return whole_; }
  /// As prepared.
  [[nodiscard]] const Surface& of(Sharpness sharpness) const noexcept;
  /// The base of a picture with four rays per pixel, apart from that of whole().
  [[nodiscard]] const GpuImage& rest() const noexcept { return rest_; }
  [[nodiscard]] bool holds(vk::Extent2D picture) const noexcept { return whole_.picture == picture; }
  [[nodiscard]] bool holdsRest(vk::Extent2D picture) const noexcept { return rest_picture_ == picture; }

  /// Records that the base of `from`, just drawn, is resized into that of whole(). Enlarged, the panels show it, the rest is
  /// `ground` [linear light], as a frame of every pixel leaves it there: bands of it may follow. Grounds are whole codes, so that both
  /// ways of clearing give the same.
  void recordResized(const vk::raii::CommandBuffer& commands, const Surface& from,
                     std::span<const LivePanel> panels, const glm::vec3& ground) const;
  /// The same of the fine surface into rest().
  void recordReducedToRest(const vk::raii::CommandBuffer& commands) const;

 private:
  [[nodiscard]] GpuImage baseOf(vk::Extent2D size) const;
  void make(Surface& surface, vk::Extent2D picture, vk::Extent2D size) const;
  void makeFine(vk::Extent2D picture);
  void makeSmall(Surface& surface, vk::Extent2D picture, Resize::Times times,
                 std::unique_ptr<Resize>& enlarge);
  static void beforeResize(const vk::raii::CommandBuffer& commands, const Surface& from, const GpuImage& to);

  Context& context_;
  vk::Format colour_;
  std::uint32_t count_;
  LivePrograms& programs_;
  Surface whole_, half_, quarter_, fine_;
  std::unique_ptr<Resize> enlarge_, enlarge_more_, reduce_;
  GpuImage rest_;
  vk::Extent2D rest_picture_;
  std::unique_ptr<Resize> reduce_to_rest_;
};

}  // namespace fettle::render
