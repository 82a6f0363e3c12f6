#pragma once

#include <vector>

#include "render/vulkan/context.h"

namespace fettle::render {

/// The images that a window shows in turn. Created again when the window's size changes.
///
/// Guarantees 8 bits per channel, not sRGB-decoded on a copy (UNORM), and FIFO order: no tearing, never
/// faster than the display. Does not support: wide gamut, several frames in flight - a frame is completed
/// before it is shown, so that measured times are those of visible frames.
///
/// Threading: as Context. Throws vk::SystemError; vk::OutOfDateKHRError never.
class Swapchain {
 public:
  /// For pictures of this format.
  Swapchain(Context& context, vk::Format source);

  /// Fits the images to a frame of this size, or to the surface's own size where the window system dictates
  /// one. False while there is nothing to show on (minimised).
  [[nodiscard]] bool fit(vk::Extent2D wanted);
  [[nodiscard]] vk::Extent2D extent() const noexcept { return extent_; }

  /// Copies `source` (colour, in eTransferSrcOptimal, of extent()) to the next image and presents it.
  /// `record` comes before the copy in the same submission; returns when the device has completed it, calling
  /// `while_waiting`, if any, about every millisecond until then, and `before_showing`, if any, when the
  /// image is ready. False: the size is no longer right, call fit() again.
  [[nodiscard]] bool show(vk::Image source, const std::function<void(const vk::raii::CommandBuffer&)>& record,
                          const std::function<void()>& while_waiting,
                          const std::function<void()>& before_showing);
  /// How long the last show() waited for an image, which is as long as the display takes while all are in use.
  [[nodiscard]] double waitedMs() const noexcept { return waited_ms_; }

 private:
  void copyOrConvert(vk::Image source, std::uint32_t index);

  Context& context_;
  vk::Format source_format_;
  vk::SurfaceFormatKHR format_;
  vk::Extent2D extent_;
  double waited_ms_ = 0.0;
  vk::raii::SwapchainKHR swapchain_ = nullptr;
  std::vector<vk::Image> images_;
  vk::raii::Semaphore acquired_ = nullptr;
  std::vector<vk::raii::Semaphore> drawn_;  // one per image: presentation may hold the last one
  vk::raii::CommandPool pool_ = nullptr;
  vk::raii::CommandBuffer commands_ = nullptr;
  vk::raii::Fence done_ = nullptr;
};

}  // namespace fettle::render
