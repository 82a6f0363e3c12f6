#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "render/plan/picture.h"
#include "render/vulkan/vulkan.h"

namespace fettle::render {

/// What the validation layers say, collected from whatever thread they say it on.
class DebugMessages {
 public:
  void add(std::string message) {
    const std::lock_guard lock(mutex_);
    // A message a draw would fill the memory; the first ones tell the story.
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

/// What a context must be able to show pictures in: a window system's surface.
struct SurfaceWish {
  std::vector<const char*> instance_extensions;  ///< what the window system asks for
  /// Makes the window's surface; the context owns it. Throws vk::SystemError.
  std::function<VkSurfaceKHR(VkInstance)> make;
};

/// The way to one Vulkan device: instance, device, one queue that draws and copies (and shows, where a
/// surface was wished for), one command pool. Promises Vulkan 1.3 with dynamic rendering and
/// synchronization2, and sampling of 32-bit and 8-bit unsigned images. Leaves out: windows, several queues,
/// memory management beyond one allocation a resource.
///
/// Threading: one thread at a time. Functions other than create() throw vk::SystemError; live_picture.cpp and
/// window.cpp turn that into an Error.
class Context {
 public:
  /// The best device that starts; with `wish` only of those that can show pictures on its surface. Errors
  /// (kFailed): no Vulkan loader, driver or suitable device - the line says why each device found was rejected
  /// and what to install; validation layers asked for but not installed.
  [[nodiscard]] static engine::Result<std::unique_ptr<Context>> create(const DeviceOptions& options,
                                                                       const SurfaceWish* wish = nullptr);
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
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
  /// Whether all of them come out right. Mesa's llvmpipe puts primitives that it has to clip into one view,
  /// those of all views (seen with 22.3.6): what crosses the plot's edge is missing in one eye and too much
  /// in the other.
  [[nodiscard]] bool multiviewWorks() const noexcept { return multiview_ && !llvmpipe_; }
  /// The window's; null without a wish.
  [[nodiscard]] vk::SurfaceKHR surface() const noexcept { return *surface_; }

  /// Records commands by `record`, runs them and waits until they are done.
  void run(const std::function<void(const vk::raii::CommandBuffer&)>& record);

  /// Index of a memory type that is in `allowed_bits` and has all of `wanted`; throws when there is none.
  [[nodiscard]] std::uint32_t memoryType(std::uint32_t allowed_bits, vk::MemoryPropertyFlags wanted) const;

 private:
  Context() = default;
  /// Makes device, queue and pool; nothing when it throws.
  void startDevice(const vk::raii::PhysicalDevice& physical, std::uint32_t family,
                   const std::vector<const char*>& extensions);

  // Destroyed in reverse: device before messenger before instance, and what the messenger writes to last.
  std::unique_ptr<DebugMessages> messages_ = std::make_unique<DebugMessages>();
  vk::raii::Context loader_;
  vk::raii::Instance instance_ = nullptr;
  vk::raii::DebugUtilsMessengerEXT messenger_ = nullptr;
  vk::raii::SurfaceKHR surface_ = nullptr;
  std::uint32_t family_ = 0;
  bool multiview_ = false, llvmpipe_ = false;
  vk::raii::PhysicalDevice physical_ = nullptr;
  vk::PhysicalDeviceLimits limits_;
  vk::PhysicalDeviceMemoryProperties memory_;
  std::string name_;
  vk::raii::Device device_ = nullptr;
  vk::raii::Queue queue_ = nullptr;
  vk::raii::CommandPool pool_ = nullptr;
};

/// Why a device will not do; empty when it will. `queue_family` is set to the family to use when it will.
/// `surface`: what it must be able to show pictures on; null for none.
[[nodiscard]] std::string rejection(const vk::raii::PhysicalDevice& device, std::uint32_t& queue_family,
                                    vk::SurfaceKHR surface = {});

}  // namespace fettle::render
