#include "render/xr/xr_images.h"

namespace fettle::render {
namespace {

// For an image that a runtime holds: some frames. Longer, and the thread could not be ended meanwhile.
constexpr XrDuration kLongestWait_ns = 200'000'000;

}  // namespace

XrResult XrImages::make(const XrCalls& calls, XrSession session, const Context& context, vk::Format format,
                        vk::Extent2D extent, std::uint32_t layers) {
  xr_ = &calls;
  extent_ = extent;
  auto info = typed<XrSwapchainCreateInfo>(XR_TYPE_SWAPCHAIN_CREATE_INFO);
  info.usageFlags = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_TRANSFER_DST_BIT;
  info.format = static_cast<std::int64_t>(format);
  info.sampleCount = 1;
  info.width = extent.width;
  info.height = extent.height;
  info.faceCount = 1;
  info.arraySize = layers;
  info.mipCount = 1;
  if (const XrResult made = xr_->CreateSwapchain(session, &info, &swapchain_); XR_FAILED(made)) return made;
  std::uint32_t count = 0;
  if (const XrResult r = xr_->EnumerateSwapchainImages(swapchain_, 0, &count, nullptr); XR_FAILED(r))
    return r;
  std::vector<XrSwapchainImageVulkan2KHR> images(count,
                                                 {XR_TYPE_SWAPCHAIN_IMAGE_VULKAN2_KHR, nullptr, nullptr});
  const XrResult result = xr_->EnumerateSwapchainImages(
      swapchain_, count, &count, reinterpret_cast<XrSwapchainImageBaseHeader*>(images.data()));
  if (XR_FAILED(result)) return result;
  for (const XrSwapchainImageVulkan2KHR& image : images) {
    images_.emplace_back(image.image);
    vk::ImageViewCreateInfo view;
    view.setImage(images_.back())
        .setViewType(layers > 1 ? vk::ImageViewType::e2DArray : vk::ImageViewType::e2D)
        .setFormat(format)
        .setSubresourceRange({vk::ImageAspectFlagBits::eColor, 0, 1, 0, layers});
    views_.emplace_back(context.device(), view);
  }
  return XR_SUCCESS;
}

void XrImages::destroy() {
  awaited_.reset();
  views_.clear();
  images_.clear();
  if (swapchain_ != XR_NULL_HANDLE) (void)xr_->DestroySwapchain(swapchain_);
  swapchain_ = XR_NULL_HANDLE;
}

XrResult XrImages::acquire(One& one) {
  if (!awaited_) {
    std::uint32_t index = 0;
    const XrSwapchainImageAcquireInfo acquire{XR_TYPE_SWAPCHAIN_IMAGE_ACQUIRE_INFO, nullptr};
    if (const XrResult result = xr_->AcquireSwapchainImage(swapchain_, &acquire, &index); XR_FAILED(result))
      return result;
    awaited_ = index;
  }
  const XrSwapchainImageWaitInfo wait{XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO, nullptr, kLongestWait_ns};
  const XrResult result = xr_->WaitSwapchainImage(swapchain_, &wait);
  if (XR_FAILED(result) || result == XR_TIMEOUT_EXPIRED) return result;
  one = {images_[*awaited_], *views_[*awaited_]};
  awaited_.reset();
  return result;
}

XrResult XrImages::release() {
  const XrSwapchainImageReleaseInfo info{XR_TYPE_SWAPCHAIN_IMAGE_RELEASE_INFO, nullptr};
  return xr_->ReleaseSwapchainImage(swapchain_, &info);
}

XrSwapchainSubImage XrImages::part(std::uint32_t layer) const noexcept {
  return {swapchain_,
          {{0, 0}, {static_cast<std::int32_t>(extent_.width), static_cast<std::int32_t>(extent_.height)}},
          layer};
}

}  // namespace fettle::render
