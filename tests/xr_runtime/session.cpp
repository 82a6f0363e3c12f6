#include <algorithm>
#include <cmath>
#include <cstring>

#include "tests/xr_runtime/keeper.h"

namespace fettle::tests::xr {

namespace {

const char* nameOf(XrSessionState state) {
  switch (state) {
    case XR_SESSION_STATE_IDLE:
      return "IDLE";
    case XR_SESSION_STATE_READY:
      return "READY";
    case XR_SESSION_STATE_SYNCHRONIZED:
      return "SYNCHRONIZED";
    case XR_SESSION_STATE_VISIBLE:
      return "VISIBLE";
    case XR_SESSION_STATE_FOCUSED:
      return "FOCUSED";
    case XR_SESSION_STATE_STOPPING:
      return "STOPPING";
    case XR_SESSION_STATE_LOSS_PENDING:
      return "LOSS_PENDING";
    case XR_SESSION_STATE_EXITING:
      return "EXITING";
    default:
      return "UNKNOWN";
  }
}

const XrSession kSession = reinterpret_cast<XrSession>(0x2);
// The program ends within seconds whatever its headset does.
constexpr XrDuration kLongestTimeout_ns = 1'000'000'000;

XRAPI_ATTR XrResult XRAPI_CALL createSession(XrInstance, const XrSessionCreateInfo* info,
                                             XrSession* session) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  const auto* binding = static_cast<const XrGraphicsBindingVulkan2KHR*>(info->next);
  if (binding == nullptr || binding->type != XR_TYPE_GRAPHICS_BINDING_VULKAN2_KHR)
    return XR_ERROR_GRAPHICS_DEVICE_INVALID;
  if (!r.asked_requirements)
    return r.wrong("a session before the requirements were asked for",
                   XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING);
  if (r.session) return XR_ERROR_LIMIT_REACHED;
  r.vk_instance = binding->instance;
  r.physical = binding->physicalDevice;
  r.device = binding->device;
  r.family = binding->queueFamilyIndex;
  vkGetDeviceQueue(r.device, r.family, binding->queueIndex, &r.queue);
  r.session = true;
  r.lost = r.running = r.attached = r.asked_exit = r.waited = r.begun = false;
  r.frame = 0;
  r.state = XR_SESSION_STATE_UNKNOWN;
  r.enter(XR_SESSION_STATE_IDLE);
  r.enter(XR_SESSION_STATE_READY);
  *session = kSession;
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL destroySession(XrSession) {
  Runtime& r = runtime();
  keeper().finish();
  const std::lock_guard lock(r.mutex);
  if (!r.session) return XR_ERROR_HANDLE_INVALID;
  // Its children go with it.
  for (Swapchain* swapchain : r.swapchains) {
    destroyImages(*swapchain);
    delete swapchain;
  }
  r.swapchains.clear();
  r.session = false;
  r.device = VK_NULL_HANDLE;
  r.say("session destroyed");
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL beginSession(XrSession, const XrSessionBeginInfo* info) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.lost) return XR_ERROR_SESSION_LOST;
  if (r.running) return r.wrong("a session that runs is begun", XR_ERROR_SESSION_RUNNING);
  if (r.state != XR_SESSION_STATE_READY)
    return r.wrong("a session that is not ready is begun", XR_ERROR_SESSION_NOT_READY);
  if (info->primaryViewConfigurationType != XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO)
    return XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED;
  r.running = true;
  r.say("session begun");
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL endSession(XrSession) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.lost) return XR_ERROR_SESSION_LOST;
  if (!r.running) return r.wrong("a session that does not run is ended", XR_ERROR_SESSION_NOT_RUNNING);
  if (r.state != XR_SESSION_STATE_STOPPING)
    return r.wrong("a session is ended that was not asked to stop", XR_ERROR_SESSION_NOT_STOPPING);
  r.running = false;
  r.say("session ended");
  r.enter(XR_SESSION_STATE_IDLE);
  r.enter(XR_SESSION_STATE_EXITING);
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL requestExit(XrSession) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.lost) return XR_ERROR_SESSION_LOST;
  if (!r.running)
    return r.wrong("a session that does not run is asked to exit", XR_ERROR_SESSION_NOT_RUNNING);
  r.say("exit requested");
  r.asked_exit = true;
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL swapchainFormats(XrSession, std::uint32_t capacity, std::uint32_t* count,
                                                std::int64_t* to) {
  if (runtime().lost) return XR_ERROR_SESSION_LOST;
  return giveList<std::int64_t>({VK_FORMAT_B8G8R8A8_SRGB, VK_FORMAT_R8G8B8A8_SRGB}, capacity, count, to);
}

Swapchain* of(XrSwapchain handle) {
  return reinterpret_cast<Swapchain*>(handle);
}

XRAPI_ATTR XrResult XRAPI_CALL createSwapchain(XrSession, const XrSwapchainCreateInfo* info,
                                               XrSwapchain* handle) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.lost) return XR_ERROR_SESSION_LOST;
  if (info->format != VK_FORMAT_B8G8R8A8_SRGB && info->format != VK_FORMAT_R8G8B8A8_SRGB)
    return XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED;
  auto swapchain = std::make_unique<Swapchain>();
  swapchain->info = *info;
  swapchain->info.next = nullptr;
  if (!makeImages(*swapchain)) {
    destroyImages(*swapchain);
    return XR_ERROR_OUT_OF_MEMORY;
  }
  *handle = reinterpret_cast<XrSwapchain>(swapchain.get());
  r.say("swapchain " + std::to_string(info->width) + " x " + std::to_string(info->height) + " x " +
        std::to_string(info->arraySize));
  r.swapchains.insert(swapchain.release());
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL destroySwapchain(XrSwapchain handle) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.swapchains.erase(of(handle)) == 0) return XR_ERROR_HANDLE_INVALID;
  r.say("swapchain destroyed");
  destroyImages(*of(handle));
  delete of(handle);
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL swapchainImages(XrSwapchain handle, std::uint32_t capacity,
                                               std::uint32_t* count, XrSwapchainImageBaseHeader* to) {
  const Swapchain& swapchain = *of(handle);
  *count = static_cast<std::uint32_t>(swapchain.images.size());
  if (capacity == 0) return XR_SUCCESS;
  if (capacity < *count) return XR_ERROR_SIZE_INSUFFICIENT;
  auto* images = reinterpret_cast<XrSwapchainImageVulkan2KHR*>(to);
  for (std::uint32_t i = 0; i < *count; ++i) images[i].image = swapchain.images[i];
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL acquireImage(XrSwapchain handle, const XrSwapchainImageAcquireInfo*,
                                            std::uint32_t* index) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.lost) return XR_ERROR_SESSION_LOST;
  Swapchain& swapchain = *of(handle);
  if (swapchain.state != Swapchain::Image::kFree) return r.wrong("an image is acquired twice");
  swapchain.state = Swapchain::Image::kAcquired;
  swapchain.current = swapchain.next;
  swapchain.next = (swapchain.next + 1) % static_cast<std::uint32_t>(swapchain.images.size());
  *index = swapchain.current;
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL waitImage(XrSwapchain handle, const XrSwapchainImageWaitInfo* info) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.lost) return XR_ERROR_SESSION_LOST;
  Swapchain& swapchain = *of(handle);
  if (swapchain.state != Swapchain::Image::kAcquired)
    return r.wrong("an image is waited for that is not acquired");
  if (info->timeout > kLongestTimeout_ns)
    return r.wrong("an image is waited for longer than a thread that ends may");
  if (r.script.has("busy", r.frame)) return XR_TIMEOUT_EXPIRED;
  swapchain.state = Swapchain::Image::kWaited;
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL releaseImage(XrSwapchain handle, const XrSwapchainImageReleaseInfo*) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.lost) return XR_ERROR_SESSION_LOST;
  Swapchain& swapchain = *of(handle);
  if (swapchain.state != Swapchain::Image::kWaited)
    return r.wrong("an image is released that was not waited for");
  swapchain.state = Swapchain::Image::kFree;
  swapchain.released = static_cast<int>(swapchain.current);
  return XR_SUCCESS;
}

}  // namespace

void Runtime::enter(XrSessionState next) {
  if (next == state) return;
  state = next;
  say(std::string("state ") + nameOf(next));
  XrEventDataBuffer buffer{};
  XrEventDataSessionStateChanged event{XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED};
  event.session = kSession;
  event.state = next;
  event.time = nowNs();
  std::memcpy(&buffer, &event, sizeof(event));
  events.push_back(buffer);
}

void Runtime::moveRoom() {
  say("room moved");
  XrEventDataBuffer buffer{};
  XrEventDataReferenceSpaceChangePending event{XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING};
  event.session = kSession;
  event.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_STAGE;
  event.changeTime = nowNs();
  event.poseInPreviousSpace = {{0, 0, 0, 1}, {0, 0, 0}};
  std::memcpy(&buffer, &event, sizeof(event));
  events.push_back(buffer);
}

void addSessionCalls(Calls& calls) {
  calls["xrCreateSession"] = asVoid(&createSession);
  calls["xrDestroySession"] = asVoid(&destroySession);
  calls["xrBeginSession"] = asVoid(&beginSession);
  calls["xrEndSession"] = asVoid(&endSession);
  calls["xrRequestExitSession"] = asVoid(&requestExit);
  calls["xrEnumerateSwapchainFormats"] = asVoid(&swapchainFormats);
  calls["xrCreateSwapchain"] = asVoid(&createSwapchain);
  calls["xrDestroySwapchain"] = asVoid(&destroySwapchain);
  calls["xrEnumerateSwapchainImages"] = asVoid(&swapchainImages);
  calls["xrAcquireSwapchainImage"] = asVoid(&acquireImage);
  calls["xrWaitSwapchainImage"] = asVoid(&waitImage);
  calls["xrReleaseSwapchainImage"] = asVoid(&releaseImage);
}

}  // namespace fettle::tests::xr
