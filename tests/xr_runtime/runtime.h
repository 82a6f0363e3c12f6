// A runtime of OpenXR for tests, written from the specification (Khronos, The OpenXR Specification 1.0): no headset, but
// poses from a script, pictures kept as files, and a check of the order of calls. The loader finds it by XR_RUNTIME_JSON.
//
//   FETTLE_XR_SCRIPT   the script (script.h); without one the instance is refused
//   FETTLE_XR_KEEP     folder for log.txt and the kept pictures (keeper.h)
//
// A kept frame has files for each eye's picture, for each quad, and, where there are quads, for what each eye sees of both
// ("frame10.left.seen.png").
//
// log.txt has a line for each state of the session, haptic output, kept picture, and "wrong: ..." for each call that the
// specification does not allow at that time.
#pragma once

#include <array>
#include <chrono>
#include <deque>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

#define XR_USE_GRAPHICS_API_VULKAN
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include "tests/xr_runtime/script.h"

namespace fettle::tests::xr {

struct Swapchain {
  XrSwapchainCreateInfo info{};
  std::vector<VkImage> images;
  std::vector<VkDeviceMemory> memory;
  std::uint32_t next = 0;
  enum class Image { kFree, kAcquired, kWaited } state = Image::kFree;
  std::uint32_t current = 0;  // the one acquired
  int released = -1;          // the last one
};

struct Space {
  bool is_action = false;
  XrReferenceSpaceType reference = XR_REFERENCE_SPACE_TYPE_LOCAL;
  XrPosef offset{};
  std::string hand;  // "left" or "right", of an action's
};

struct Action {
  XrActionType type{};
  std::string name;
  std::map<std::string, std::string>
      bound;  // by hand: the component, "trigger", "squeeze", "scroll", "button"; empty: a pose or an output
};

/// All of it: one instance and one session at a time.
struct Runtime {
  std::mutex mutex;
  Script script;
  std::string keep;
  std::ofstream log;

  bool instance = false;
  bool asked_requirements = false;
  std::vector<std::string> paths;  // XrPath: index + 1
  std::deque<XrEventDataBuffer> events;
  std::map<XrPath, std::vector<XrActionSuggestedBinding>> suggested;

  // Of the graphics binding.
  VkInstance vk_instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t family = 0;

  bool session = false;
  bool running = false;
  bool lost = false;
  bool attached = false;
  bool asked_exit = false;
  XrSessionState state = XR_SESSION_STATE_UNKNOWN;
  bool seen = true;  // by the script
  long frame = 0;    // of xrWaitFrame
  bool waited = false, begun = false;
  XrTime shown = 0;  // of the frame waited for
  XrTime last_wake = 0;
  long synced = 0;
  std::set<XrSession> sessions;
  std::set<Swapchain*> swapchains;

  void say(const std::string& line);
  /// Notes a call that is not allowed; returns what the call returns.
  XrResult wrong(const std::string& what, XrResult result = XR_ERROR_CALL_ORDER_INVALID);
  void enter(XrSessionState next);
  /// Says that the room has another origin from now on.
  void moveRoom();
  [[nodiscard]] std::string pathOf(XrPath path) const;
};

[[nodiscard]] Runtime& runtime();

[[nodiscard]] XrTime nowNs();
[[nodiscard]] XrPosef poseOf(const Place& place);
[[nodiscard]] XrPosef times(const XrPosef& a, const XrPosef& b);
[[nodiscard]] XrPosef inverse(const XrPosef& a);

/// Pixels in rows from the top: red, green, blue, opacity; sRGB.
struct Pixels {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};
/// A part of a layer of an image of the session's device. The image is in the layout that a released one has.
[[nodiscard]] bool readPicture(VkImage image, VkFormat format, const XrRect2Di& part, std::uint32_t layer,
                               Pixels& pixels);
/// Writes them to a file (PNG).
[[nodiscard]] bool keepPicture(const Pixels& pixels, const std::string& path);
/// Draws a quad over what an eye at `eye` sees; both poses in the room.
void composeQuad(const XrCompositionLayerQuad& quad, const XrPosef& pose, const Pixels& picture,
                 const XrPosef& eye, const XrFovf& fov, Pixels& seen);
/// Where a space is in the room; false where it is not tracked.
[[nodiscard]] bool placeOf(XrSpace space, XrPosef& pose);
[[nodiscard]] XrVector3f turned(const XrQuaternionf& turn, const XrVector3f& vector);
/// Makes and destroys the images of a swapchain.
[[nodiscard]] bool makeImages(Swapchain& swapchain);
void destroyImages(Swapchain& swapchain);

/// The functions of each file by name, for xrGetInstanceProcAddr.
using Calls = std::map<std::string, PFN_xrVoidFunction>;
void addInstanceCalls(Calls& calls);
void addGraphicsCalls(Calls& calls);
void addSessionCalls(Calls& calls);
void addFrameCalls(Calls& calls);
void addSpaceCalls(Calls& calls);
void addActionCalls(Calls& calls);

template <class Function>
PFN_xrVoidFunction asVoid(Function* function) {
  return reinterpret_cast<PFN_xrVoidFunction>(function);
}

/// The two calls by which a list is asked for: first its length, then its content.
template <class Item>
XrResult giveList(const std::vector<Item>& items, std::uint32_t capacity, std::uint32_t* count, Item* to) {
  *count = static_cast<std::uint32_t>(items.size());
  if (capacity == 0) return XR_SUCCESS;
  if (capacity < items.size()) return XR_ERROR_SIZE_INSUFFICIENT;
  for (std::size_t i = 0; i < items.size(); ++i) to[i] = items[i];
  return XR_SUCCESS;
}

}  // namespace fettle::tests::xr
