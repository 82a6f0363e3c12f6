// A Vulkan layer that takes the device away, as a driver does that restarts or hangs: what was handed over is
// never said to be done, every call that can say VK_ERROR_DEVICE_LOST says so, and what was made with the
// device can still be destroyed. Between the program and the driver, so that the program under test is the
// one that ships.
//
// $FETTLE_LOSE_DEVICE names a file with orders, a line each, the first one next; the file is read at each
// call that may carry one out, and written again without the line when that has happened:
//
//   lose WHERE     the device is lost at the next WHERE:
//                    surface   submission that draws by dynamic rendering (the picture)
//                    upload    submission that copies a buffer to an image (tiles)
//                    panels    submission with a render pass (the user interface)
//                    compute   submission with a compute shader (filters)
//                    acquire, present   of the swap chain
//   gone           no device starts any more
//   refuse         the next device does not start
//   outdated WHERE, suboptimal WHERE   the swap chain no longer fits the window, at acquire or present
//   memory         the next image or buffer does not get its memory
//   pass compute   a submission with a compute shader is let through
//
// With $FETTLE_AS_HARDWARE every device says that it is a discrete graphics card.
//
// $FETTLE_FRAME_GATE names a socket that says when each frame may be shown: frame_gate.h.
//
// Layer interface: "Architecture of the Vulkan Loader Interfaces", KhronosGroup/Vulkan-Loader.
#include <cstdlib>
#include <cstring>

#include <fstream>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

namespace {

// Of frame_gate.h: what each frame passes before it is shown. One thread.
class Gate {
 public:
  void pass() {
    if (!asked_) connectTo(std::getenv("FETTLE_FRAME_GATE"));
    if (free_) take(MSG_DONTWAIT);
    if (free_ || socket_ < 0) return;
    const char waits = 'w';
    (void)send(socket_, &waits, 1, MSG_NOSIGNAL);
    take(0);
  }

 private:
  void connectTo(const char* path) {
    asked_ = true;
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path == nullptr || std::strlen(path) >= sizeof(address.sun_path)) return;
    std::memcpy(address.sun_path, path, std::strlen(path));
    socket_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) leave();
  }
  // An order, if there is one; waits for one unless it may not wait.
  void take(int flags) {
    char order = 0;
    if (socket_ < 0) return;
    const ssize_t got = recv(socket_, &order, 1, flags);
    if (got == 1) free_ = order == 'f';
    if (got == 0) leave();
  }
  void leave() {
    close(socket_);
    socket_ = -1;
    free_ = true;
  }

  bool asked_ = false;
  bool free_ = true;
  int socket_ = -1;
};
Gate gate;

std::mutex mutex;  // over all below

struct Instance {
  VkInstance handle = VK_NULL_HANDLE;
  PFN_vkGetInstanceProcAddr next = nullptr;
  // Asked for when the instance is made: later another layer may answer with this one's.
  PFN_vkDestroyInstance destroy = nullptr;
  PFN_vkGetPhysicalDeviceProperties properties = nullptr;
};
struct Device {
  VkDevice handle = VK_NULL_HANDLE;
  PFN_vkGetDeviceProcAddr next = nullptr;
  bool lost = false;
  struct Content {
    bool draws = false, uploads = false, panels = false, computes = false;
  };
  std::map<VkCommandBuffer, Content> recorded;
};
// By the pointer that the loader puts first into each dispatchable object: the same for a device, its queues
// and its command buffers.
using Key = void*;
std::map<Key, Instance> instances;
std::map<Key, Device> devices;

template <class Handle>
Key keyOf(Handle handle) {
  return *reinterpret_cast<Key*>(handle);
}
template <class Handle>
Device& deviceOf(Handle handle) {
  return devices.at(keyOf(handle));
}
template <class Function>
Function next(const Device& device, const char* name) {
  return reinterpret_cast<Function>(device.next(device.handle, name));
}

const char* ordersPath() {
  return std::getenv("FETTLE_LOSE_DEVICE");
}
// Whether the next order is this one; it is then done, but for "gone", which stays.
bool ordered(const std::string& order) {
  const char* path = ordersPath();
  if (path == nullptr) return false;
  std::vector<std::string> lines;
  {
    std::ifstream in(path);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
  }
  if (lines.empty() || lines.front() != order) return false;
  if (order == "gone") return true;
  // Written as another file and renamed: whoever looks sees either all of the lines or all but the first.
  const std::string temporary = std::string(path) + ".new";
  {
    std::ofstream out(temporary);
    for (std::size_t i = 1; i < lines.size(); ++i) out << lines[i] << '\n';
  }
  std::rename(temporary.c_str(), path);
  return true;
}

void lose(Device& device) {
  device.lost = true;
  // The driver below is well, and its objects are about to be destroyed: nothing may be under way.
  next<PFN_vkDeviceWaitIdle>(device, "vkDeviceWaitIdle")(device.handle);
}

VKAPI_ATTR VkResult VKAPI_CALL queueSubmit2(VkQueue queue, std::uint32_t count, const VkSubmitInfo2* submits,
                                            VkFence fence) {
  const std::scoped_lock lock(mutex);
  Device& device = deviceOf(queue);
  Device::Content content;
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::uint32_t k = 0; k < submits[i].commandBufferInfoCount; ++k) {
      const Device::Content& c = device.recorded[submits[i].pCommandBufferInfos[k].commandBuffer];
      content.draws |= c.draws;
      content.uploads |= c.uploads;
      content.panels |= c.panels;
      content.computes |= c.computes;
    }
  if (!device.lost &&
      ((content.draws && ordered("lose surface")) || (content.uploads && ordered("lose upload")) ||
       (content.panels && ordered("lose panels")) ||
       (content.computes && !ordered("pass compute") && ordered("lose compute"))))
    lose(device);
  if (device.lost) return VK_ERROR_DEVICE_LOST;
  return next<PFN_vkQueueSubmit2>(device, "vkQueueSubmit2")(queue, count, submits, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL queuePresent(VkQueue queue, const VkPresentInfoKHR* info) {
  gate.pass();
  PFN_vkQueuePresentKHR down = nullptr;
  {
    const std::scoped_lock lock(mutex);
    Device& device = deviceOf(queue);
    if (!device.lost && ordered("lose present")) lose(device);
    if (device.lost) return VK_ERROR_DEVICE_LOST;
    down = next<PFN_vkQueuePresentKHR>(device, "vkQueuePresentKHR");
  }
  const VkResult result = down(queue, info);
  const std::scoped_lock lock(mutex);
  if (result == VK_SUCCESS && ordered("outdated present")) return VK_ERROR_OUT_OF_DATE_KHR;
  if (result == VK_SUCCESS && ordered("suboptimal present")) return VK_SUBOPTIMAL_KHR;
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL acquireNextImage(VkDevice handle, VkSwapchainKHR swapchain,
                                                std::uint64_t timeout, VkSemaphore semaphore, VkFence fence,
                                                std::uint32_t* index) {
  PFN_vkAcquireNextImageKHR down = nullptr;
  {
    const std::scoped_lock lock(mutex);
    Device& device = deviceOf(handle);
    if (!device.lost && ordered("lose acquire")) lose(device);
    if (device.lost) return VK_ERROR_DEVICE_LOST;
    if (ordered("outdated acquire")) return VK_ERROR_OUT_OF_DATE_KHR;
    down = next<PFN_vkAcquireNextImageKHR>(device, "vkAcquireNextImageKHR");
  }
  const VkResult result = down(handle, swapchain, timeout, semaphore, fence, index);
  const std::scoped_lock lock(mutex);
  return result == VK_SUCCESS && ordered("suboptimal acquire") ? VK_SUBOPTIMAL_KHR : result;
}

// Calls that wait, and those that ask: lost, or passed on without the lock, since they may take long.
#define ANSWER_OR_PASS(Name, ...)                  \
  PFN_vk##Name down = nullptr;                     \
  {                                                \
    const std::scoped_lock lock(mutex);            \
    const Device& device = deviceOf(handle);       \
    if (device.lost) return VK_ERROR_DEVICE_LOST;  \
    down = next<PFN_vk##Name>(device, "vk" #Name); \
  }                                                \
  return down(handle, ##__VA_ARGS__)

VKAPI_ATTR VkResult VKAPI_CALL waitForFences(VkDevice handle, std::uint32_t count, const VkFence* fences,
                                             VkBool32 all, std::uint64_t timeout) {
  ANSWER_OR_PASS(WaitForFences, count, fences, all, timeout);
}
VKAPI_ATTR VkResult VKAPI_CALL getFenceStatus(VkDevice handle, VkFence fence) {
  ANSWER_OR_PASS(GetFenceStatus, fence);
}
VKAPI_ATTR VkResult VKAPI_CALL deviceWaitIdle(VkDevice handle) {
  ANSWER_OR_PASS(DeviceWaitIdle);
}
VKAPI_ATTR VkResult VKAPI_CALL queueWaitIdle(VkQueue handle) {
  ANSWER_OR_PASS(QueueWaitIdle);
}

VKAPI_ATTR VkResult VKAPI_CALL allocateMemory(VkDevice handle, const VkMemoryAllocateInfo* info,
                                              const VkAllocationCallbacks* allocator,
                                              VkDeviceMemory* memory) {
  const std::scoped_lock lock(mutex);
  Device& device = deviceOf(handle);
  if (ordered("memory")) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  return next<PFN_vkAllocateMemory>(device, "vkAllocateMemory")(handle, info, allocator, memory);
}

VKAPI_ATTR VkResult VKAPI_CALL beginCommandBuffer(VkCommandBuffer commands,
                                                  const VkCommandBufferBeginInfo* info) {
  const std::scoped_lock lock(mutex);
  Device& device = deviceOf(commands);
  device.recorded[commands] = {};
  return next<PFN_vkBeginCommandBuffer>(device, "vkBeginCommandBuffer")(commands, info);
}
VKAPI_ATTR void VKAPI_CALL beginRendering(VkCommandBuffer commands, const VkRenderingInfo* info) {
  const std::scoped_lock lock(mutex);
  Device& device = deviceOf(commands);
  device.recorded[commands].draws = true;
  next<PFN_vkCmdBeginRendering>(device, "vkCmdBeginRendering")(commands, info);
}
VKAPI_ATTR void VKAPI_CALL beginRenderPass(VkCommandBuffer commands, const VkRenderPassBeginInfo* info,
                                           VkSubpassContents contents) {
  const std::scoped_lock lock(mutex);
  Device& device = deviceOf(commands);
  device.recorded[commands].panels = true;
  next<PFN_vkCmdBeginRenderPass>(device, "vkCmdBeginRenderPass")(commands, info, contents);
}
VKAPI_ATTR void VKAPI_CALL copyBufferToImage(VkCommandBuffer commands, VkBuffer buffer, VkImage image,
                                             VkImageLayout layout, std::uint32_t count,
                                             const VkBufferImageCopy* regions) {
  const std::scoped_lock lock(mutex);
  Device& device = deviceOf(commands);
  device.recorded[commands].uploads = true;
  next<PFN_vkCmdCopyBufferToImage>(device, "vkCmdCopyBufferToImage")(commands, buffer, image, layout, count,
                                                                     regions);
}

VKAPI_ATTR void VKAPI_CALL dispatch(VkCommandBuffer commands, std::uint32_t x, std::uint32_t y,
                                    std::uint32_t z) {
  const std::scoped_lock lock(mutex);
  Device& device = deviceOf(commands);
  device.recorded[commands].computes = true;
  next<PFN_vkCmdDispatch>(device, "vkCmdDispatch")(commands, x, y, z);
}

VKAPI_ATTR void VKAPI_CALL getPhysicalDeviceProperties(VkPhysicalDevice physical,
                                                       VkPhysicalDeviceProperties* properties) {
  PFN_vkGetPhysicalDeviceProperties down = nullptr;
  {
    const std::scoped_lock lock(mutex);
    down = instances.at(keyOf(physical)).properties;
  }
  down(physical, properties);
  if (std::getenv("FETTLE_AS_HARDWARE") != nullptr)
    properties->deviceType = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
}

// The loader's chain of layers: the element that is for this one.
template <class Info>
Info* linkIn(const void* chain, VkStructureType type) {
  for (auto* info = static_cast<const Info*>(chain); info != nullptr;
       info = static_cast<const Info*>(info->pNext))
    if (info->sType == type && info->function == VK_LAYER_LINK_INFO) return const_cast<Info*>(info);
  return nullptr;
}

VKAPI_ATTR VkResult VKAPI_CALL createInstance(const VkInstanceCreateInfo* info,
                                              const VkAllocationCallbacks* allocator, VkInstance* instance) {
  auto* link = linkIn<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  if (link == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
  const PFN_vkGetInstanceProcAddr get = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateInstance>(get(VK_NULL_HANDLE, "vkCreateInstance"));
  const VkResult result = create(info, allocator, instance);
  const std::scoped_lock lock(mutex);
  if (result == VK_SUCCESS)
    instances[keyOf(*instance)] = {
        *instance, get, reinterpret_cast<PFN_vkDestroyInstance>(get(*instance, "vkDestroyInstance")),
        reinterpret_cast<PFN_vkGetPhysicalDeviceProperties>(get(*instance, "vkGetPhysicalDeviceProperties"))};
  return result;
}
VKAPI_ATTR void VKAPI_CALL destroyInstance(VkInstance instance, const VkAllocationCallbacks* allocator) {
  const std::scoped_lock lock(mutex);
  const Key key = keyOf(instance);
  instances.at(key).destroy(instance, allocator);
  instances.erase(key);
}

VKAPI_ATTR VkResult VKAPI_CALL createDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                            const VkAllocationCallbacks* allocator, VkDevice* device) {
  auto* link = linkIn<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  if (link == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
  const std::scoped_lock lock(mutex);
  if (ordered("gone") || ordered("refuse")) return VK_ERROR_INITIALIZATION_FAILED;
  const PFN_vkGetInstanceProcAddr get = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  const PFN_vkGetDeviceProcAddr get_device = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const VkInstance instance = instances.at(keyOf(physical)).handle;
  const auto create = reinterpret_cast<PFN_vkCreateDevice>(get(instance, "vkCreateDevice"));
  const VkResult result = create(physical, info, allocator, device);
  if (result == VK_SUCCESS) {
    Device& made = devices[keyOf(*device)];
    made = {};
    made.handle = *device;
    made.next = get_device;
  }
  return result;
}
VKAPI_ATTR void VKAPI_CALL destroyDevice(VkDevice device, const VkAllocationCallbacks* allocator) {
  const std::scoped_lock lock(mutex);
  const Key key = keyOf(device);
  next<PFN_vkDestroyDevice>(devices.at(key), "vkDestroyDevice")(device, allocator);
  devices.erase(key);
}

PFN_vkVoidFunction own(const char* name) {
  static const std::map<std::string, PFN_vkVoidFunction> functions{
      {"vkCreateInstance", reinterpret_cast<PFN_vkVoidFunction>(&createInstance)},
      {"vkDestroyInstance", reinterpret_cast<PFN_vkVoidFunction>(&destroyInstance)},
      {"vkCreateDevice", reinterpret_cast<PFN_vkVoidFunction>(&createDevice)},
      {"vkDestroyDevice", reinterpret_cast<PFN_vkVoidFunction>(&destroyDevice)},
      {"vkQueueSubmit2", reinterpret_cast<PFN_vkVoidFunction>(&queueSubmit2)},
      {"vkQueuePresentKHR", reinterpret_cast<PFN_vkVoidFunction>(&queuePresent)},
      {"vkAcquireNextImageKHR", reinterpret_cast<PFN_vkVoidFunction>(&acquireNextImage)},
      {"vkWaitForFences", reinterpret_cast<PFN_vkVoidFunction>(&waitForFences)},
      {"vkGetFenceStatus", reinterpret_cast<PFN_vkVoidFunction>(&getFenceStatus)},
      {"vkDeviceWaitIdle", reinterpret_cast<PFN_vkVoidFunction>(&deviceWaitIdle)},
      {"vkQueueWaitIdle", reinterpret_cast<PFN_vkVoidFunction>(&queueWaitIdle)},
      {"vkAllocateMemory", reinterpret_cast<PFN_vkVoidFunction>(&allocateMemory)},
      {"vkBeginCommandBuffer", reinterpret_cast<PFN_vkVoidFunction>(&beginCommandBuffer)},
      {"vkCmdBeginRendering", reinterpret_cast<PFN_vkVoidFunction>(&beginRendering)},
      {"vkCmdBeginRenderPass", reinterpret_cast<PFN_vkVoidFunction>(&beginRenderPass)},
      {"vkCmdCopyBufferToImage", reinterpret_cast<PFN_vkVoidFunction>(&copyBufferToImage)},
      {"vkCmdDispatch", reinterpret_cast<PFN_vkVoidFunction>(&dispatch)},
      {"vkGetPhysicalDeviceProperties", reinterpret_cast<PFN_vkVoidFunction>(&getPhysicalDeviceProperties)},
  };
  const auto found = functions.find(name);
  return found != functions.end() ? found->second : nullptr;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getDeviceProcAddr(VkDevice device, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&getDeviceProcAddr);
  if (const PFN_vkVoidFunction function = own(name)) return function;
  const std::scoped_lock lock(mutex);
  const Device& below = deviceOf(device);
  return below.next(device, name);
}
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getInstanceProcAddr(VkInstance instance, const char* name) {
  if (std::strcmp(name, "vkGetInstanceProcAddr") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&getInstanceProcAddr);
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&getDeviceProcAddr);
  if (const PFN_vkVoidFunction function = own(name)) return function;
  if (instance == VK_NULL_HANDLE) return nullptr;
  const std::scoped_lock lock(mutex);
  return instances.at(keyOf(instance)).next(instance, name);
}

}  // namespace

extern "C" VK_LAYER_EXPORT VKAPI_ATTR VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* version) {
  if (version->loaderLayerInterfaceVersion < 2) return VK_ERROR_INITIALIZATION_FAILED;
  version->loaderLayerInterfaceVersion = 2;
  version->pfnGetInstanceProcAddr = &getInstanceProcAddr;
  version->pfnGetDeviceProcAddr = &getDeviceProcAddr;
  version->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}
