#include "render/vulkan/context.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "engine/base/lower_case.h"

namespace fettle::render {
namespace {

constexpr const char* kInstall = "install a Vulkan driver, on Debian: apt install mesa-vulkan-drivers";
constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL collect(VkDebugUtilsMessageSeverityFlagBitsEXT /*severity*/,
                                       VkDebugUtilsMessageTypeFlagsEXT /*types*/,
                                       const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  static_cast<DebugMessages*>(user)->add(data->pMessage != nullptr ? data->pMessage : "");
  return VK_FALSE;
}

vk::DebugUtilsMessengerCreateInfoEXT messengerInfo(DebugMessages* messages) {
  using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
  using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
  // "General" messages come from the loader: which drivers it found and which could not be loaded.
  return {
      {}, Severity::eWarning | Severity::eError, Type::eValidation | Type::ePerformance, &collect, messages};
}

int preference(vk::PhysicalDeviceType type) {
  switch (type) {
    case vk::PhysicalDeviceType::eDiscreteGpu:
      return 4;
    case vk::PhysicalDeviceType::eIntegratedGpu:
      return 3;
    case vk::PhysicalDeviceType::eVirtualGpu:
      return 2;
    case vk::PhysicalDeviceType::eCpu:
      return 1;
    default:
      return 0;
  }
}

bool layerInstalled(const vk::raii::Context& loader) {
  const auto layers = loader.enumerateInstanceLayerProperties();
  return std::any_of(layers.begin(), layers.end(), [](const vk::LayerProperties& layer) {
    return std::strcmp(layer.layerName, kValidationLayer) == 0;
  });
}

// Whether the device is a processor whose images can lie over the host's memory.
bool drawsOverHostMemory(const vk::raii::PhysicalDevice& device) {
  if (device.getProperties().deviceType != vk::PhysicalDeviceType::eCpu) return false;
  const auto extensions = device.enumerateDeviceExtensionProperties();
  return std::any_of(extensions.begin(), extensions.end(), [](const vk::ExtensionProperties& extension) {
    return std::strcmp(extension.extensionName, VK_EXT_EXTERNAL_MEMORY_HOST_EXTENSION_NAME) == 0;
  });
}

vk::DeviceSize hostImageAlignmentOf(const vk::raii::PhysicalDevice& device) {
  return device
      .getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceExternalMemoryHostPropertiesEXT>()
      .get<vk::PhysicalDeviceExternalMemoryHostPropertiesEXT>()
      .minImportedHostPointerAlignment;
}

std::string nameWithDriver(const vk::raii::PhysicalDevice& device) {
  const auto properties =
      device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>();
  const auto& driver = properties.get<vk::PhysicalDeviceDriverProperties>();
  return fmt::format("{} ({} {})",
                     properties.get<vk::PhysicalDeviceProperties2>().properties.deviceName.data(),
                     driver.driverName.data(), driver.driverInfo.data());
}

}  // namespace

std::string rejection(const vk::raii::PhysicalDevice& device, std::uint32_t& queue_family,
                      vk::SurfaceKHR surface) {
  const vk::PhysicalDeviceProperties properties = device.getProperties();
  if (properties.apiVersion < VK_API_VERSION_1_3)
    return fmt::format("offers Vulkan {}.{}, 1.3 is needed", VK_API_VERSION_MAJOR(properties.apiVersion),
                       VK_API_VERSION_MINOR(properties.apiVersion));
  const auto chain = device.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan13Features>();
  const auto& features = chain.get<vk::PhysicalDeviceVulkan13Features>();
  if (!features.dynamicRendering) return "has no dynamic rendering";
  if (!features.synchronization2) return "has no synchronization2";
  const auto can = [&](vk::Format format, vk::FormatFeatureFlags required) {
    return (device.getFormatProperties(format).optimalTilingFeatures & required) == required;
  };
  using F = vk::FormatFeatureFlagBits;
  if (!can(vk::Format::eR32Uint, F::eSampledImage | F::eTransferDst))
    return "cannot sample 32-bit unsigned images";
  if (!can(vk::Format::eR8Uint, F::eSampledImage | F::eTransferDst))
    return "cannot sample 8-bit unsigned images";
  if (!can(vk::Format::eR8G8B8A8Srgb, F::eColorAttachment | F::eColorAttachmentBlend | F::eSampledImage))
    return "cannot draw to sRGB images";
  if (!can(vk::Format::eD32Sfloat, F::eDepthStencilAttachment)) return "has no 32-bit depth";
  const auto families = device.getQueueFamilyProperties();
  bool draws = false;
  for (std::uint32_t i = 0; i < families.size(); ++i)
    if (families[i].queueFlags & vk::QueueFlagBits::eGraphics) {
      draws = true;
      if (surface && device.getSurfaceSupportKHR(i, surface) == VK_FALSE) continue;
      queue_family = i;
      return {};
    }
  return draws ? "cannot show pictures in this window" : "has no queue that draws";
}

Context::~Context() {
  // No work may be in progress when the resources are destroyed; a lost device has none.
  if (*device_) try {
      device_.waitIdle();
    } catch (const vk::SystemError&) {
    }
}

engine::Result<std::unique_ptr<Context>> Context::create(const DeviceOptions& options,
                                                         const SurfaceRequest* request,
                                                         const VulkanMaker* maker) try {
  std::unique_ptr<Context> context(new Context());
  const bool validate = options.validation == Validation::kOn;
  if (context->loader_.enumerateInstanceVersion() < VK_API_VERSION_1_3)
    return engine::failure("the Vulkan loader is older than 1.3", "Vulkan",
                           "on Debian: apt install libvulkan1");
  if (validate && !layerInstalled(context->loader_))
    return engine::failure("the validation layers are not installed", "Vulkan",
                           "on Debian: apt install vulkan-validationlayers");
  const vk::ApplicationInfo application{"fettle", 1, "fettle", 1, VK_API_VERSION_1_3};
  std::vector<const char*> layers, extensions;
  vk::InstanceCreateInfo instance_info{{}, &application};
  const vk::DebugUtilsMessengerCreateInfoEXT messenger = messengerInfo(context->messages_.get());
  if (validate) {
    layers.push_back(kValidationLayer);
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    instance_info.pNext = &messenger;  // for the creation and destruction of the instance itself
  }
  if (request != nullptr)
    extensions.insert(extensions.end(), request->instance_extensions.begin(),
                      request->instance_extensions.end());
  instance_info.setPEnabledLayerNames(layers).setPEnabledExtensionNames(extensions);
  context->instance_ = maker == nullptr
                           ? vk::raii::Instance(context->loader_, instance_info)
                           : vk::raii::Instance(context->loader_, maker->instance(instance_info));
  if (validate) context->messenger_ = vk::raii::DebugUtilsMessengerEXT(context->instance_, messenger);
  if (request != nullptr)
    context->surface_ = vk::raii::SurfaceKHR(context->instance_, request->make(*context->instance_));

  vk::raii::PhysicalDevices devices = nullptr;
  try {
    devices = vk::raii::PhysicalDevices(context->instance_);
  } catch (const vk::SystemError&) {
    // No driver at all: some loaders report that as an error, others as an empty list.
  }
  std::string reasons;
  const auto reject = [&](const std::string& name, const std::string& why) {
    reasons += fmt::format("{}\"{}\" {}", reasons.empty() ? "" : "; ", name, why);
  };
  struct Candidate {
    int preference = 0;
    std::uint32_t family = 0;
    vk::raii::PhysicalDevice device = nullptr;
  };
  std::vector<Candidate> candidates;
  const VkPhysicalDevice chosen = maker == nullptr ? VK_NULL_HANDLE : maker->physical(*context->instance_);
  for (vk::raii::PhysicalDevice& device : devices) {
    if (chosen != VK_NULL_HANDLE && static_cast<VkPhysicalDevice>(*device) != chosen) continue;
    const vk::PhysicalDeviceProperties properties = device.getProperties();
    const std::string name = properties.deviceName;
    std::uint32_t family = 0;
    std::string reason = rejection(device, family, *context->surface_);
    if (reason.empty() && engine::lowerCase(nameWithDriver(device)).find(engine::lowerCase(options.device)) ==
                              std::string::npos)
      reason = "is not the requested one";
    if (reason.empty() && options.kind == DriverKind::kHardware &&
        properties.deviceType == vk::PhysicalDeviceType::eCpu)
      reason = "is the processor itself";
    if (!reason.empty())
      reject(name, reason);
    else
      candidates.push_back({preference(properties.deviceType), family, std::move(device)});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.preference > b.preference; });
  // A device that fails to start is still listed: then the next best draws, more slowly.
  for (Candidate& candidate : candidates) {
    std::vector<const char*> needed;
    if (request != nullptr) needed.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
    const bool over_host = request != nullptr && drawsOverHostMemory(candidate.device);
    if (over_host) needed.push_back(VK_EXT_EXTERNAL_MEMORY_HOST_EXTENSION_NAME);
    try {
      context->startDevice(candidate.device, candidate.family, needed, maker);
    } catch (const vk::SystemError& error) {
      reject(candidate.device.getProperties().deviceName, fmt::format("does not start ({})", error.what()));
      continue;
    }
    context->physical_ = std::move(candidate.device);
    if (over_host) context->host_image_alignment_ = hostImageAlignmentOf(context->physical_);
    break;
  }
  if (!*context->device_)
    return engine::failure(
        reasons.empty() ? "no Vulkan device found" : "no suitable Vulkan device: " + reasons, "Vulkan",
        options.device.empty() ? kInstall : "name another device or none");

  context->limits_ = context->physical_.getProperties().limits;
  context->name_ = nameWithDriver(context->physical_);
  context->memory_ = context->physical_.getMemoryProperties();
  return context;
} catch (const vk::SystemError& error) {
  return engine::failure(fmt::format("Vulkan does not start ({})", error.what()), "Vulkan", kInstall);
} catch (const std::exception& error) {
  // The loader itself is missing.
  return engine::failure(fmt::format("Vulkan does not start ({})", error.what()), "Vulkan",
                         "on Debian: apt install libvulkan1 mesa-vulkan-drivers");
}

void Context::startDevice(const vk::raii::PhysicalDevice& physical, std::uint32_t family,
                          const std::vector<const char*>& extensions, const VulkanMaker* maker) {
  const float priority = 1.0F;
  const vk::DeviceQueueCreateInfo queue{{}, family, 1, &priority};
  const bool multiview =
      physical.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan11Features>()
          .get<vk::PhysicalDeviceVulkan11Features>()
          .multiview != VK_FALSE;
  vk::PhysicalDeviceVulkan11Features views;
  views.multiview = multiview;
  vk::PhysicalDeviceVulkan13Features features;
  features.pNext = &views;
  features.dynamicRendering = VK_TRUE;
  features.synchronization2 = VK_TRUE;
  vk::DeviceCreateInfo device_info;
  device_info.setQueueCreateInfos(queue).setPNext(&features).setPEnabledExtensionNames(extensions);
  vk::raii::Device device = maker == nullptr
                                ? vk::raii::Device(physical, device_info)
                                : vk::raii::Device(physical, maker->device(*physical, device_info));
  pool_ = vk::raii::CommandPool(device, {vk::CommandPoolCreateFlagBits::eTransient, family});
  queue_ = vk::raii::Queue(device, family, 0);
  device_ = std::move(device);
  family_ = family;
  multiview_ = multiview;
  llvmpipe_ = physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>()
                  .get<vk::PhysicalDeviceDriverProperties>()
                  .driverID == vk::DriverId::eMesaLlvmpipe;
}

void Context::run(const std::function<void(const vk::raii::CommandBuffer&)>& record) {
  vk::raii::CommandBuffers buffers(device_, {*pool_, vk::CommandBufferLevel::ePrimary, 1});
  const vk::raii::CommandBuffer& commands = buffers.front();
  commands.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
  record(commands);
  commands.end();
  const vk::raii::Fence done(device_, vk::FenceCreateInfo{});
  const vk::CommandBufferSubmitInfo buffer(*commands);
  vk::SubmitInfo2 submit;
  submit.setCommandBufferInfos(buffer);
  queue_.submit2(submit, *done);
  (void)device_.waitForFences(*done, VK_TRUE, UINT64_MAX);
}

std::optional<std::uint32_t> Context::findMemoryType(std::uint32_t allowed_bits,
                                                     vk::MemoryPropertyFlags required) const noexcept {
  for (std::uint32_t i = 0; i < memory_.memoryTypeCount; ++i)
    if ((allowed_bits >> i & 1U) != 0 && (memory_.memoryTypes[i].propertyFlags & required) == required)
      return i;
  return std::nullopt;
}

bool Context::hasMemoryType(std::uint32_t allowed_bits, vk::MemoryPropertyFlags required) const noexcept {
  return findMemoryType(allowed_bits, required).has_value();
}

std::uint32_t Context::memoryType(std::uint32_t allowed_bits, vk::MemoryPropertyFlags required) const {
  if (const auto type = findMemoryType(allowed_bits, required)) return *type;
  throw vk::FeatureNotPresentError("no suitable memory type");
}

}  // namespace fettle::render
