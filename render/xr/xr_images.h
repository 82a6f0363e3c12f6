#pragma once

#include <optional>
#include <vector>

#include "render/vulkan/context.h"
#include "render/xr/xr_calls.h"

namespace fettle::render {

/// The images of a swapchain of the runtime, with a view of all layers of each.
class XrImages {
 public:
  [[nodiscard]] XrResult make(const XrCalls& calls, XrSession session, const Context& context,
                              vk::Format format, vk::Extent2D extent, std::uint32_t layers);
  void destroy();
  [[nodiscard]] bool made() const noexcept { return swapchain_ != XR_NULL_HANDLE; }
  [[nodiscard]] vk::Extent2D extent() const noexcept { return extent_; }
  [[nodiscard]] XrSwapchain handle() const noexcept { return swapchain_; }

  /// The next image, free to be written. XR_TIMEOUT_EXPIRED, which is no failure: the runtime still reads it; the next call waits for
  /// the same one, and nothing may be released.
  struct One {
    vk::Image image;
    vk::ImageView view;
  };
  [[nodiscard]] XrResult acquire(One& one);
  [[nodiscard]] XrResult release();
  /// All of a layer.
  [[nodiscard]] XrSwapchainSubImage part(std::uint32_t layer) const noexcept;

 private:
  const XrCalls* xr_ = nullptr;
  XrSwapchain swapchain_ = XR_NULL_HANDLE;
  vk::Extent2D extent_;
  std::vector<vk::Image> images_;
  std::vector<vk::raii::ImageView> views_;
  std::optional<std::uint32_t> awaited_;  // acquired, and not free yet
};

}  // namespace fettle::render
