#pragma once

#include <vector>

#include "render/window/presenter.h"

namespace fettle::render {

/// The images that a window shows in turn. Created again when the window's size changes.
///
/// Guarantees 8 bits per channel, not sRGB-decoded on a copy (UNORM), and FIFO order: no tearing, never
/// faster than the display. Does not support: wide gamut, several frames in flight - a frame is completed
/// before it is shown, so that measured times are those of visible frames.
class Swapchain : public Presenter {
 public:
  /// For pictures of this format.
  Swapchain(Context& context, vk::Format source);

  [[nodiscard]] bool fit(vk::Extent2D wanted) override;
  [[nodiscard]] vk::Extent2D extent() const noexcept override { return extent_; }
  [[nodiscard]] GpuImage makeImage(vk::Format format, vk::ImageUsageFlags usage) override;
  /// Copies the whole frame to the next image and presents it.
  [[nodiscard]] bool show(const FrameToShow& frame) override;
  [[nodiscard]] double waitedMs() const noexcept override { return waited_ms_; }
  [[nodiscard]] const char* name() const noexcept override { return "Vulkan"; }

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
