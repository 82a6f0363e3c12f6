#pragma once

#include <functional>
#include <vector>

#include "render/plan/camera.h"
#include "render/vulkan/memory.h"

namespace fettle::render {

/// What a frame is shown with.
struct FrameToShow {
  vk::Image image;  ///< that makeImage() made, in eTransferSrcOptimal after `record`
  /// Comes before the copy of the image in the same submission. Returns the places of the image that it changed, disjoint
  /// and inside of it; empty: the frame before is right.
  std::function<std::vector<Rectangle>(const vk::raii::CommandBuffer&)> record;
  /// About every millisecond while the device or the display is waited for; may be empty.
  std::function<void()> while_waiting;
  /// When the image is ready; may be empty.
  std::function<void()> before_showing;
};

/// Brings frames into a window: through Vulkan's own way (Swapchain), or through memory shared with the display's server
/// (SharedFrames).
///
/// Threading: as Context. Throws vk::SystemError; vk::OutOfDateKHRError never.
class Presenter {
 public:
  virtual ~Presenter() = default;
  Presenter& operator=(Presenter&&) = delete;

  /// Fits to a frame of this size, or to the window's own size where the window system dictates one. False while there
  /// is nothing to show on (minimised).
  [[nodiscard]] virtual bool fit(vk::Extent2D wanted) = 0;
  [[nodiscard]] virtual vk::Extent2D extent() const noexcept = 0;
  /// An image of that extent for frames, in place of the one before, which must be gone.
  [[nodiscard]] virtual GpuImage makeImage(vk::Format format, vk::ImageUsageFlags usage) = 0;
  /// Waits as long as frames would otherwise come faster than anybody can see them: before a frame takes what it is going to show,
  /// which would be older by as much afterwards. `while_waiting`: as FrameToShow's.
  virtual void keepPace(const std::function<void()>& while_waiting) { (void)while_waiting; }
  /// Shows a frame; returns when the device has completed it. False: the size is no longer right, call fit() again.
  [[nodiscard]] virtual bool show(const FrameToShow& frame) = 0;
  /// How long the last show() waited for an image, which is as long as the display takes while all are in use.
  [[nodiscard]] virtual double waitedMs() const noexcept = 0;
  /// The display has lost some of what it showed.
  virtual void forget() noexcept {}
  /// In words, for reports.
  [[nodiscard]] virtual const char* name() const noexcept = 0;

 protected:
  Presenter() = default;
};

}  // namespace fettle::render
