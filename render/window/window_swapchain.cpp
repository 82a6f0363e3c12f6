#include "render/window/window_swapchain.h"

#include <algorithm>

#include "engine/base/stopwatch.h"
#include "render/vulkan/barrier.h"
#include "render/vulkan/memory.h"

namespace fettle::render {
namespace {

constexpr std::uint64_t kForever = UINT64_MAX;
constexpr std::uint64_t kLook_ns = 1'000'000;

vk::SurfaceFormatKHR chooseFormat(const std::vector<vk::SurfaceFormatKHR>& offered) {
  for (const vk::Format wanted : {vk::Format::eB8G8R8A8Unorm, vk::Format::eR8G8B8A8Unorm})
    for (const vk::SurfaceFormatKHR& format : offered)
      if (format.format == wanted && format.colorSpace == vk::ColorSpaceKHR::eSrgbNonlinear) return format;
  throw vk::FormatNotSupportedError("the display takes no 8-bit pictures");
}

}  // namespace

Swapchain::Swapchain(Context& context, vk::Format source) : context_(context), source_format_(source) {
  format_ = chooseFormat(context_.physical().getSurfaceFormatsKHR(context_.surface()));
  const vk::raii::Device& device = context_.device();
  pool_ = vk::raii::CommandPool(device,
                                {vk::CommandPoolCreateFlagBits::eResetCommandBuffer, context_.queueFamily()});
  commands_ =
      std::move(vk::raii::CommandBuffers(device, {*pool_, vk::CommandBufferLevel::ePrimary, 1}).front());
  done_ = vk::raii::Fence(device, vk::FenceCreateInfo{});
  acquired_ = vk::raii::Semaphore(device, vk::SemaphoreCreateInfo{});
}

bool Swapchain::fit(vk::Extent2D wanted) {
  const vk::SurfaceCapabilitiesKHR can = context_.physical().getSurfaceCapabilitiesKHR(context_.surface());
  vk::Extent2D extent = can.currentExtent;
  if (extent.width == UINT32_MAX) {  // the window system leaves it to the program
    extent.width = std::clamp(wanted.width, can.minImageExtent.width, can.maxImageExtent.width);
    extent.height = std::clamp(wanted.height, can.minImageExtent.height, can.maxImageExtent.height);
  }
  if (extent.width == 0 || extent.height == 0) return false;
  if (extent == extent_ && *swapchain_) return true;
  if (!(can.supportedUsageFlags & vk::ImageUsageFlagBits::eTransferDst))
    throw vk::FeatureNotPresentError("the display takes no copied pictures");
  std::uint32_t count = can.minImageCount + 1;
  if (can.maxImageCount > 0) count = std::min(count, can.maxImageCount);
  vk::SwapchainCreateInfoKHR info;
  info.setSurface(context_.surface())
      .setMinImageCount(count)
      .setImageFormat(format_.format)
      .setImageColorSpace(format_.colorSpace)
      .setImageExtent(extent)
      .setImageArrayLayers(1)
      .setImageUsage(vk::ImageUsageFlagBits::eTransferDst)
      .setPreTransform(can.currentTransform)
      .setCompositeAlpha(can.supportedCompositeAlpha & vk::CompositeAlphaFlagBitsKHR::eOpaque
                             ? vk::CompositeAlphaFlagBitsKHR::eOpaque
                             : vk::CompositeAlphaFlagBitsKHR::eInherit)
      .setPresentMode(vk::PresentModeKHR::eFifo)
      .setClipped(VK_TRUE)
      .setOldSwapchain(*swapchain_);
  context_.device().waitIdle();
  vk::raii::SwapchainKHR fresh(context_.device(), info);
  swapchain_ = std::move(fresh);
  images_.clear();
  for (const VkImage image : swapchain_.getImages()) images_.emplace_back(image);
  drawn_.clear();
  for (std::size_t i = 0; i < images_.size(); ++i)
    drawn_.emplace_back(context_.device(), vk::SemaphoreCreateInfo{});
  // An image acquired but never presented may have left its semaphore signalled.
  acquired_ = vk::raii::Semaphore(context_.device(), vk::SemaphoreCreateInfo{});
  extent_ = extent;
  return true;
}

// As it is where the display has the same order of channels, which for a processor that draws is a tenth of the work.
void Swapchain::copyOrConvert(vk::Image source, std::uint32_t index) {
  constexpr vk::ImageSubresourceLayers kColour{vk::ImageAspectFlagBits::eColor, 0, 0, 1};
  if (format_.format == source_format_) {
    const vk::ImageCopy copy(kColour, {}, kColour, {}, {extent_.width, extent_.height, 1});
    commands_.copyImage(source, ImageLayout::eTransferSrcOptimal, images_[index],
                        ImageLayout::eTransferDstOptimal, copy);
    return;
  }
  const std::array<vk::Offset3D, 2> all{
      vk::Offset3D{0, 0, 0},
      vk::Offset3D{static_cast<std::int32_t>(extent_.width), static_cast<std::int32_t>(extent_.height), 1}};
  const vk::ImageBlit blit(kColour, all, kColour, all);
  commands_.blitImage(source, ImageLayout::eTransferSrcOptimal, images_[index],
                      ImageLayout::eTransferDstOptimal, blit, vk::Filter::eNearest);
}

GpuImage Swapchain::makeImage(vk::Format format, vk::ImageUsageFlags usage) {
  return {context_, format, extent_, 1, GpuImage::Kind::kPlane, usage, vk::ImageAspectFlagBits::eColor};
}

bool Swapchain::show(const FrameToShow& frame) {
  const std::function<void()>& while_waiting = frame.while_waiting;
  std::uint32_t index = 0;
  bool right_size = true;
  const engine::Stopwatch watch;
  waited_ms_ = 0.0;
  try {
    // FIFO: while all images wait for the display this takes as long as the display does.
    std::pair<vk::Result, std::uint32_t> next;
    do {
      next = swapchain_.acquireNextImage(while_waiting ? kLook_ns : kForever, *acquired_);
      if (next.first == vk::Result::eTimeout || next.first == vk::Result::eNotReady) while_waiting();
    } while (next.first == vk::Result::eTimeout || next.first == vk::Result::eNotReady);
    waited_ms_ = watch.ms();
    index = next.second;
    right_size = next.first != vk::Result::eSuboptimalKHR;
  } catch (const vk::OutOfDateKHRError&) {
    extent_ = vk::Extent2D{};
    return false;
  }
  commands_.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
  (void)frame.record(commands_);
  change(commands_, images_[index], ImageLayout::eUndefined, ImageLayout::eTransferDstOptimal,
         Stage::eAllTransfer, {}, Stage::eAllTransfer, Access::eTransferWrite);
  copyOrConvert(frame.image, index);
  change(commands_, images_[index], ImageLayout::eTransferDstOptimal, ImageLayout::ePresentSrcKHR,
         Stage::eAllTransfer, Access::eTransferWrite, Stage::eNone, {});
  commands_.end();

  const vk::SemaphoreSubmitInfo wait(*acquired_, 0, Stage::eAllTransfer);
  const vk::SemaphoreSubmitInfo signal(*drawn_[index], 0, Stage::eAllTransfer);
  const vk::CommandBufferSubmitInfo buffer(*commands_);
  vk::SubmitInfo2 submit;
  submit.setWaitSemaphoreInfos(wait).setSignalSemaphoreInfos(signal).setCommandBufferInfos(buffer);
  context_.queue().submit2(submit, *done_);
  while (context_.device().waitForFences(*done_, VK_TRUE, while_waiting ? kLook_ns : kForever) ==
         vk::Result::eTimeout)
    while_waiting();
  context_.device().resetFences(*done_);

  if (frame.before_showing) frame.before_showing();
  vk::PresentInfoKHR present;
  present.setWaitSemaphores(*drawn_[index]).setSwapchains(*swapchain_).setImageIndices(index);
  try {
    right_size = context_.queue().presentKHR(present) == vk::Result::eSuccess && right_size;
  } catch (const vk::OutOfDateKHRError&) {
    right_size = false;
  }
  if (!right_size) extent_ = vk::Extent2D{};
  return right_size;
}

}  // namespace fettle::render
