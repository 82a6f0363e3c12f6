#pragma once

#include <string>

#include "engine/base/error.h"
#include "render/xr/openxr.h"

namespace fettle::render {

/// The functions of OpenXR that a headset needs, from the loader's library, which is loaded here and nowhere else.
struct XrCalls {
  PFN_xrGetInstanceProcAddr GetInstanceProcAddr = nullptr;
  PFN_xrEnumerateInstanceExtensionProperties EnumerateInstanceExtensionProperties = nullptr;
  PFN_xrCreateInstance CreateInstance = nullptr;

// Of an instance.
#define FETTLE_XR_CALLS(CALL)             \
  CALL(DestroyInstance)                   \
  CALL(PollEvent)                         \
  CALL(GetSystem)                         \
  CALL(GetSystemProperties)               \
  CALL(EnumerateEnvironmentBlendModes)    \
  CALL(EnumerateViewConfigurationViews)   \
  CALL(StringToPath)                      \
  CALL(GetVulkanGraphicsRequirements2KHR) \
  CALL(CreateVulkanInstanceKHR)           \
  CALL(GetVulkanGraphicsDevice2KHR)       \
  CALL(CreateVulkanDeviceKHR)             \
  CALL(CreateSession)                     \
  CALL(DestroySession)                    \
  CALL(BeginSession)                      \
  CALL(EndSession)                        \
  CALL(RequestExitSession)                \
  CALL(EnumerateReferenceSpaces)          \
  CALL(CreateReferenceSpace)              \
  CALL(CreateActionSpace)                 \
  CALL(LocateSpace)                       \
  CALL(LocateViews)                       \
  CALL(DestroySpace)                      \
  CALL(EnumerateSwapchainFormats)         \
  CALL(CreateSwapchain)                   \
  CALL(DestroySwapchain)                  \
  CALL(EnumerateSwapchainImages)          \
  CALL(AcquireSwapchainImage)             \
  CALL(WaitSwapchainImage)                \
  CALL(ReleaseSwapchainImage)             \
  CALL(WaitFrame)                         \
  CALL(BeginFrame)                        \
  CALL(EndFrame)                          \
  CALL(CreateActionSet)                   \
  CALL(DestroyActionSet)                  \
  CALL(CreateAction)                      \
  CALL(SuggestInteractionProfileBindings) \
  CALL(AttachSessionActionSets)           \
  CALL(SyncActions)                       \
  CALL(GetActionStateBoolean)             \
  CALL(GetActionStateFloat)               \
  CALL(ApplyHapticFeedback)               \
  CALL(StopHapticFeedback)
#define FETTLE_XR_DECLARE(name) PFN_xr##name name = nullptr;
  FETTLE_XR_CALLS(FETTLE_XR_DECLARE)
#undef FETTLE_XR_DECLARE

  /// Loads the library. Errors (kFailed): it is not installed.
  [[nodiscard]] engine::Status load();
  /// Looks up the functions of an instance. Errors (kFailed): the runtime has not all of them.
  [[nodiscard]] engine::Status find(XrInstance instance);
};

/// What a failed call means to a user.
[[nodiscard]] std::string reasonOf(XrResult result);

}  // namespace fettle::render
