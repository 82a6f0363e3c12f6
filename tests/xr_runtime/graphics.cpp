#include <cstring>

#include <png.h>

#include "tests/xr_runtime/runtime.h"

namespace fettle::tests::xr {

namespace {

XRAPI_ATTR XrResult XRAPI_CALL requirements(XrInstance, XrSystemId, XrGraphicsRequirementsVulkan2KHR* needs) {
  needs->minApiVersionSupported = XR_MAKE_VERSION(1, 1, 0);
  needs->maxApiVersionSupported = XR_MAKE_VERSION(1, 3, 0);
  runtime().asked_requirements = true;
  return XR_SUCCESS;
}

template <class Function>
Function vulkanCall(PFN_vkGetInstanceProcAddr get, VkInstance instance, const char* name) {
  return reinterpret_cast<Function>(get(instance, name));
}

XRAPI_ATTR XrResult XRAPI_CALL createVulkanInstance(XrInstance, const XrVulkanInstanceCreateInfoKHR* info,
                                                    VkInstance* instance, VkResult* result) {
  Runtime& r = runtime();
  if (!r.asked_requirements)
    return r.wrong("a Vulkan instance before the requirements were asked for",
                   XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING);
  *result = vulkanCall<PFN_vkCreateInstance>(info->pfnGetInstanceProcAddr, nullptr, "vkCreateInstance")(
      info->vulkanCreateInfo, info->vulkanAllocator, instance);
  r.vk_instance = *instance;
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL graphicsDevice(XrInstance, const XrVulkanGraphicsDeviceGetInfoKHR* info,
                                              VkPhysicalDevice* device) {
  std::uint32_t count = 1;
  // The first of its list: a person with a headset has it plugged into one device.
  const VkResult result = vkEnumeratePhysicalDevices(info->vulkanInstance, &count, device);
  return (result == VK_SUCCESS || result == VK_INCOMPLETE) && count == 1 ? XR_SUCCESS
                                                                         : XR_ERROR_RUNTIME_FAILURE;
}

XRAPI_ATTR XrResult XRAPI_CALL createVulkanDevice(XrInstance, const XrVulkanDeviceCreateInfoKHR* info,
                                                  VkDevice* device, VkResult* result) {
  *result =
      vulkanCall<PFN_vkCreateDevice>(info->pfnGetInstanceProcAddr, runtime().vk_instance, "vkCreateDevice")(
          info->vulkanPhysicalDevice, info->vulkanCreateInfo, info->vulkanAllocator, device);
  return XR_SUCCESS;
}

std::uint32_t memoryType(std::uint32_t bits, VkMemoryPropertyFlags needed) {
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(runtime().physical, &memory);
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i)
    if ((bits >> i & 1U) != 0 && (memory.memoryTypes[i].propertyFlags & needed) == needed) return i;
  return 0;
}

VkDeviceMemory memoryFor(const VkMemoryRequirements& needs, VkMemoryPropertyFlags kind) {
  VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = memoryType(needs.memoryTypeBits, kind);
  VkDeviceMemory memory = VK_NULL_HANDLE;
  return vkAllocateMemory(runtime().device, &allocate, nullptr, &memory) == VK_SUCCESS ? memory
                                                                                       : VK_NULL_HANDLE;
}

}  // namespace

bool makeImages(Swapchain& swapchain) {
  constexpr int kImages = 3;
  const XrSwapchainCreateInfo& info = swapchain.info;
  for (int i = 0; i < kImages; ++i) {
    VkImageCreateInfo image{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    image.imageType = VK_IMAGE_TYPE_2D;
    image.format = static_cast<VkFormat>(info.format);
    image.extent = {info.width, info.height, 1};
    image.mipLevels = info.mipCount;
    image.arrayLayers = info.arraySize;
    image.samples = VK_SAMPLE_COUNT_1_BIT;
    image.usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT;  // to keep it
    if ((info.usageFlags & XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT) != 0)
      image.usage |= VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    if ((info.usageFlags & XR_SWAPCHAIN_USAGE_TRANSFER_DST_BIT) != 0)
      image.usage |= VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    if ((info.usageFlags & XR_SWAPCHAIN_USAGE_SAMPLED_BIT) != 0) image.usage |= VK_IMAGE_USAGE_SAMPLED_BIT;
    VkImage made = VK_NULL_HANDLE;
    if (vkCreateImage(runtime().device, &image, nullptr, &made) != VK_SUCCESS) return false;
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(runtime().device, made, &needs);
    swapchain.images.push_back(made);
    swapchain.memory.push_back(memoryFor(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT));
    if (swapchain.memory.back() == VK_NULL_HANDLE) return false;
    vkBindImageMemory(runtime().device, made, swapchain.memory.back(), 0);
  }
  return true;
}

void destroyImages(Swapchain& swapchain) {
  if (runtime().device == VK_NULL_HANDLE) return;
  vkDeviceWaitIdle(runtime().device);
  for (VkImage image : swapchain.images) vkDestroyImage(runtime().device, image, nullptr);
  for (VkDeviceMemory memory : swapchain.memory) vkFreeMemory(runtime().device, memory, nullptr);
}

bool keepPicture(const Pixels& pixels, const std::string& path) {
  png_image picture{};
  picture.version = PNG_IMAGE_VERSION;
  picture.width = static_cast<png_uint_32>(pixels.width);
  picture.height = static_cast<png_uint_32>(pixels.height);
  picture.format = PNG_FORMAT_RGBA;
  return png_image_write_to_file(&picture, path.c_str(), 0, pixels.rgba.data(), 0, nullptr) != 0;
}

bool readPicture(VkImage image, VkFormat format, const XrRect2Di& part, std::uint32_t layer, Pixels& pixels) {
  const Runtime& r = runtime();
  VkDevice device = r.device;
  const auto width = static_cast<std::uint32_t>(part.extent.width);
  const auto height = static_cast<std::uint32_t>(part.extent.height);
  VkBufferCreateInfo buffer_info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  buffer_info.size = VkDeviceSize{4} * width * height;
  buffer_info.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  VkBuffer buffer = VK_NULL_HANDLE;
  vkCreateBuffer(device, &buffer_info, nullptr, &buffer);
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device, buffer, &needs);
  VkDeviceMemory memory =
      memoryFor(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  vkBindBufferMemory(device, buffer, memory, 0);
  VkCommandPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool_info.queueFamilyIndex = r.family;
  VkCommandPool pool = VK_NULL_HANDLE;
  vkCreateCommandPool(device, &pool_info, nullptr, &pool);
  VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  allocate.commandPool = pool;
  allocate.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  vkAllocateCommandBuffers(device, &allocate, &commands);
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  vkBeginCommandBuffer(commands, &begin);
  VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
  barrier.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
  // The layout in which the extension XR_KHR_vulkan_enable2 asks for a released image.
  barrier.oldLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  barrier.newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, layer, 1};
  const auto turn = [&] {
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0,
                         0, nullptr, 0, nullptr, 1, &barrier);
  };
  turn();
  VkBufferImageCopy copy{};
  copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, layer, 1};
  copy.imageOffset = {part.offset.x, part.offset.y, 0};
  copy.imageExtent = {width, height, 1};
  vkCmdCopyImageToBuffer(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer, 1, &copy);
  std::swap(barrier.oldLayout, barrier.newLayout);
  barrier.srcAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
  barrier.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
  turn();
  vkEndCommandBuffer(commands);
  VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &commands;
  bool kept = vkQueueSubmit(r.queue, 1, &submit, VK_NULL_HANDLE) == VK_SUCCESS &&
              vkQueueWaitIdle(r.queue) == VK_SUCCESS;
  void* bytes = nullptr;
  if (kept && vkMapMemory(device, memory, 0, VK_WHOLE_SIZE, 0, &bytes) == VK_SUCCESS) {
    const auto* from = static_cast<const std::uint8_t*>(bytes);
    pixels = {part.extent.width, part.extent.height, {from, from + std::size_t{4} * width * height}};
    if (format == VK_FORMAT_B8G8R8A8_SRGB)
      for (std::size_t i = 0; i < pixels.rgba.size(); i += 4) std::swap(pixels.rgba[i], pixels.rgba[i + 2]);
    vkUnmapMemory(device, memory);
  }
  vkDestroyCommandPool(device, pool, nullptr);
  vkDestroyBuffer(device, buffer, nullptr);
  vkFreeMemory(device, memory, nullptr);
  return kept;
}

void addGraphicsCalls(Calls& calls) {
  calls["xrGetVulkanGraphicsRequirements2KHR"] = asVoid(&requirements);
  calls["xrCreateVulkanInstanceKHR"] = asVoid(&createVulkanInstance);
  calls["xrGetVulkanGraphicsDevice2KHR"] = asVoid(&graphicsDevice);
  calls["xrCreateVulkanDeviceKHR"] = asVoid(&createVulkanDevice);
}

}  // namespace fettle::tests::xr
