#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "render/plan/picture.h"
#include "render/vulkan/vulkan.h"

namespace fettle::render {

/// Messages of the validation layers, from any thread.
class DebugMessages {
 public:
  void add(std::string message) {
    const std::lock_guard lock(mutex_);
    // One message per draw would fill the memory; the first ones are enough.
    if (messages_.size() < 200) messages_.push_back(std::move(message));
  }
  [[nodiscard]] std::vector<std::string> all() const {
    const std::lock_guard lock(mutex_);
    return messages_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> messages_;
};

/// A surface of a window system on which the context must be able to show pictures.
struct SurfaceRequest {
  std::vector<const char*> instance_extensions;  ///< that the window system needs
  /// Creates the window's surface; the context owns it. Throws vk::SystemError.
  std::function<VkSurfaceKHR(VkInstance)> make;
};

/// Who creates Vulkan's instance and device in place of the loader, with what it needs added: the runtime of a headset, which
/// also chooses the device. The context owns both. Throw vk::SystemError.
struct VulkanMaker {
  std::function<VkInstance(const VkInstanceCreateInfo&)> instance;
  std::function<VkPhysicalDevice(VkInstance)> physical;
  std::function<VkDevice(VkPhysicalDevice, const VkDeviceCreateInfo&)> device;
};

/// One Vulkan device: instance, device, one queue that draws and copies (and presents, where a surface was
/// requested), one command pool. Guarantees Vulkan 1.3 with dynamic rendering and synchronization2, and
/// sampling of 32-bit and 8-bit unsigned images. Does not include: windows, several queues, memory management
/// beyond one allocation per resource.
///
/// Threading: one thread at a time. Functions other than create() throw vk::SystemError; live_picture.cpp and
/// window.cpp turn that into an Error.
class Context {
 public:
  /// The best device that starts; with `surface` only of those that can present on it, with `maker` its choice. Errors (kFailed): no
  /// Vulkan loader, driver or suitable device - the message states why each device found was rejected and
  /// what to install; validation layers requested but not installed.
  [[nodiscard]] static engine::Result<std::unique_ptr<Context>> create(
      const DeviceOptions& options, const SurfaceRequest* request = nullptr,
      const VulkanMaker* maker = nullptr);
  Context& operator=(Context&&) = delete;
  ~Context();

  [[nodiscard]] const vk::raii::Device& device() const noexcept { return device_; }
  [[nodiscard]] const vk::raii::PhysicalDevice& physical() const noexcept { return physical_; }
  [[nodiscard]] const vk::PhysicalDeviceLimits& limits() const noexcept { return limits_; }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const DebugMessages& messages() const noexcept { return *messages_; }
  [[nodiscard]] const vk::raii::Instance& instance() const noexcept { return instance_; }
  [[nodiscard]] const vk::raii::Queue& queue() const noexcept { return queue_; }
  [[nodiscard]] std::uint32_t queueFamily() const noexcept { return family_; }
  /// Whether a pass can draw several views at once (every device of Vulkan 1.1 up should).
  [[nodiscard]] bool multiview() const noexcept { return multiview_; }
  /// Whether all views are drawn correctly. Mesa's llvmpipe draws clipped primitives of all views into one
  /// view (seen with 22.3.6): what crosses the plot's edge is missing in one eye and superfluous in the
  /// other.
  [[nodiscard]] bool multiviewWorks() const noexcept { return multiview_ && !llvmpipe_; }
  /// Alignment of the host's memory that images can be laid over [bytes]; 0: they cannot. Of processors that draw into a
  /// window alone: others would read such memory slowly.
  [[nodiscard]] vk::DeviceSize hostImageAlignment() const noexcept { return host_image_alignment_; }
  /// The window's; null without a surface request.
  [[nodiscard]] vk::SurfaceKHR surface() const noexcept { return *surface_; }

  /// Records commands by `record`, runs them and waits for their completion.
  void run(const std::function<void(const vk::raii::CommandBuffer&)>& record);

  /// Index of a memory type that is in `allowed_bits` and has all of `required`; throws when there is none.
  [[nodiscard]] std::uint32_t memoryType(std::uint32_t allowed_bits, vk::MemoryPropertyFlags required) const;
  [[nodiscard]] bool hasMemoryType(std::uint32_t allowed_bits,
                                   vk::MemoryPropertyFlags required) const noexcept;

 private:
  Context() = default;
  [[nodiscard]] std::optional<std::uint32_t> findMemoryType(std::uint32_t allowed_bits,
                                                            vk::MemoryPropertyFlags required) const noexcept;
  /// Creates device, queue and pool; leaves none when it throws.
  void startDevice(const vk::raii::PhysicalDevice& physical, std::uint32_t family,
                   const std::vector<const char*>& extensions, const VulkanMaker* maker);

  // Destroyed in reverse: device before messenger before instance, and the messages it writes to last.
  std::unique_ptr<DebugMessages> messages_ = std::make_unique<DebugMessages>();
  vk::raii::Context loader_;
  vk::raii::Instance instance_ = nullptr;
  vk::raii::DebugUtilsMessengerEXT messenger_ = nullptr;
  vk::raii::SurfaceKHR surface_ = nullptr;
  std::uint32_t family_ = 0;
  bool multiview_ = false, llvmpipe_ = false;
  vk::DeviceSize host_image_alignment_ = 0;
  vk::raii::PhysicalDevice physical_ = nullptr;
  vk::PhysicalDeviceLimits limits_;
  vk::PhysicalDeviceMemoryProperties memory_;
  std::string name_;
  vk::raii::Device device_ = nullptr;
  vk::raii::Queue queue_ = nullptr;
  vk::raii::CommandPool pool_ = nullptr;
};

/// Why a device is unsuitable; empty when it is suitable, then `queue_family` is set to the family to use.
/// `surface`: where it must be able to present; null for none.
[[nodiscard]] std::string rejection(const vk::raii::PhysicalDevice& device, std::uint32_t& queue_family,
                                    vk::SurfaceKHR surface = {});

}  // namespace fettle::render
