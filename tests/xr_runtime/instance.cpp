#include <cstdlib>
#include <cstring>
#include <thread>

#include "tests/xr_runtime/runtime.h"

namespace fettle::tests::xr {

namespace {

const XrInstance kInstance = reinterpret_cast<XrInstance>(0x1);
constexpr XrSystemId kSystem = 1;

XRAPI_ATTR XrResult XRAPI_CALL extensions(const char* layer, std::uint32_t capacity, std::uint32_t* count,
                                          XrExtensionProperties* to) {
  if (layer != nullptr) return XR_ERROR_API_LAYER_NOT_PRESENT;
  *count = 1;
  if (capacity == 0) return XR_SUCCESS;
  std::strcpy(to[0].extensionName, XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME);
  to[0].extensionVersion = XR_KHR_vulkan_enable2_SPEC_VERSION;
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL createInstance(const XrInstanceCreateInfo* info, XrInstance* instance) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.instance) return XR_ERROR_LIMIT_REACHED;
  // A process may make one after the other.
  r.script = {};
  r.log.close();
  r.log.clear();
  r.paths.clear();
  r.events.clear();
  r.suggested.clear();
  r.asked_requirements = false;
  r.seen = true;
  const char* keep = std::getenv("FETTLE_XR_KEEP");
  r.keep = keep != nullptr ? keep : "";
  if (!r.keep.empty()) r.log.open(r.keep + "/log.txt", std::ios::app);
  const char* script = std::getenv("FETTLE_XR_SCRIPT");
  if (script == nullptr || !r.script.read(script)) return XR_ERROR_RUNTIME_FAILURE;
  while (r.script.hangs(0)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    r.script.readOn(0);
  }
  for (std::uint32_t i = 0; i < info->enabledExtensionCount; ++i)
    if (std::strcmp(info->enabledExtensionNames[i], XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME) != 0)
      return XR_ERROR_EXTENSION_NOT_PRESENT;
  r.instance = true;
  r.say(std::string("instance for ") + info->applicationInfo.applicationName);
  *instance = kInstance;
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL destroyInstance(XrInstance) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.session) (void)r.wrong("the instance is destroyed before its session");
  r.instance = false;
  r.asked_requirements = false;
  r.say("instance destroyed");
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL instanceProperties(XrInstance, XrInstanceProperties* properties) {
  std::strcpy(properties->runtimeName, "Fettle test runtime");
  properties->runtimeVersion = XR_MAKE_VERSION(1, 0, 0);
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL pollEvent(XrInstance, XrEventDataBuffer* event) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.events.empty()) return XR_EVENT_UNAVAILABLE;
  *event = r.events.front();
  r.events.pop_front();
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL resultToString(XrInstance, XrResult value,
                                              char text[XR_MAX_RESULT_STRING_SIZE]) {
  std::snprintf(text, XR_MAX_RESULT_STRING_SIZE, "XR_RESULT_%d", static_cast<int>(value));
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL getSystem(XrInstance, const XrSystemGetInfo* info, XrSystemId* system) {
  if (info->formFactor != XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY) return XR_ERROR_FORM_FACTOR_UNSUPPORTED;
  *system = kSystem;
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL systemProperties(XrInstance, XrSystemId system,
                                                XrSystemProperties* properties) {
  if (system != kSystem) return XR_ERROR_SYSTEM_INVALID;
  properties->systemId = system;
  properties->vendorId = 0;
  std::strcpy(properties->systemName, "Scripted headset");
  properties->graphicsProperties = {4096, 4096, XR_MIN_COMPOSITION_LAYERS_SUPPORTED};
  properties->trackingProperties = {XR_TRUE, XR_TRUE};
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL blendModes(XrInstance, XrSystemId, XrViewConfigurationType,
                                          std::uint32_t capacity, std::uint32_t* count,
                                          XrEnvironmentBlendMode* to) {
  return giveList<XrEnvironmentBlendMode>({XR_ENVIRONMENT_BLEND_MODE_OPAQUE}, capacity, count, to);
}

XRAPI_ATTR XrResult XRAPI_CALL stringToPath(XrInstance, const char* text, XrPath* path) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  for (std::size_t i = 0; i < r.paths.size(); ++i)
    if (r.paths[i] == text) {
      *path = i + 1;
      return XR_SUCCESS;
    }
  r.paths.emplace_back(text);
  *path = r.paths.size();
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL pathToString(XrInstance, XrPath path, std::uint32_t capacity,
                                            std::uint32_t* count, char* to) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (path == XR_NULL_PATH || path > r.paths.size()) return XR_ERROR_PATH_INVALID;
  const std::string text = r.pathOf(path);
  return giveList(std::vector<char>(text.c_str(), text.c_str() + text.size() + 1), capacity, count, to);
}

XRAPI_ATTR XrResult XRAPI_CALL viewConfigurations(XrInstance, XrSystemId, std::uint32_t capacity,
                                                  std::uint32_t* count, XrViewConfigurationType* to) {
  return giveList<XrViewConfigurationType>({XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO}, capacity, count, to);
}

XRAPI_ATTR XrResult XRAPI_CALL viewConfigurationProperties(XrInstance, XrSystemId,
                                                           XrViewConfigurationType type,
                                                           XrViewConfigurationProperties* properties) {
  properties->viewConfigurationType = type;
  properties->fovMutable = XR_FALSE;
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL viewConfigurationViews(XrInstance, XrSystemId, XrViewConfigurationType type,
                                                      std::uint32_t capacity, std::uint32_t* count,
                                                      XrViewConfigurationView* to) {
  if (type != XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO) return XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED;
  *count = 2;
  if (capacity == 0) return XR_SUCCESS;
  if (capacity < 2) return XR_ERROR_SIZE_INSUFFICIENT;
  const auto width = static_cast<std::uint32_t>(runtime().script.width);
  const auto height = static_cast<std::uint32_t>(runtime().script.height);
  for (int i = 0; i < 2; ++i) {
    to[i].recommendedImageRectWidth = width;
    to[i].maxImageRectWidth = 4096;
    to[i].recommendedImageRectHeight = height;
    to[i].maxImageRectHeight = 4096;
    to[i].recommendedSwapchainSampleCount = 1;
    to[i].maxSwapchainSampleCount = 1;
  }
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL getInstanceProcAddr(XrInstance, const char* name,
                                                   PFN_xrVoidFunction* function) {
  static const Calls kCalls = [] {
    Calls calls;
    addInstanceCalls(calls);
    addGraphicsCalls(calls);
    addSessionCalls(calls);
    addFrameCalls(calls);
    addSpaceCalls(calls);
    addActionCalls(calls);
    return calls;
  }();
  const auto found = kCalls.find(name);
  *function = found == kCalls.end() ? nullptr : found->second;
  return *function == nullptr ? XR_ERROR_FUNCTION_UNSUPPORTED : XR_SUCCESS;
}

// Between loader and runtime (OpenXR Loader - Design and Operation, 1.0, "Runtime interface negotiation"); no header of
// the package has them.
struct LoaderInfo {
  int type;
  std::uint32_t version;
  std::size_t size;
  std::uint32_t least_interface, most_interface;
  XrVersion least_api, most_api;
};
struct RuntimeRequest {
  int type;
  std::uint32_t version;
  std::size_t size;
  std::uint32_t interface;
  XrVersion api;
  PFN_xrGetInstanceProcAddr calls;
};
constexpr int kLoaderInfo = 1, kRuntimeRequest = 3;

}  // namespace

void addInstanceCalls(Calls& calls) {
  calls["xrGetInstanceProcAddr"] = asVoid(&getInstanceProcAddr);
  calls["xrEnumerateInstanceExtensionProperties"] = asVoid(&extensions);
  calls["xrCreateInstance"] = asVoid(&createInstance);
  calls["xrDestroyInstance"] = asVoid(&destroyInstance);
  calls["xrGetInstanceProperties"] = asVoid(&instanceProperties);
  calls["xrPollEvent"] = asVoid(&pollEvent);
  calls["xrResultToString"] = asVoid(&resultToString);
  calls["xrGetSystem"] = asVoid(&getSystem);
  calls["xrGetSystemProperties"] = asVoid(&systemProperties);
  calls["xrEnumerateEnvironmentBlendModes"] = asVoid(&blendModes);
  calls["xrStringToPath"] = asVoid(&stringToPath);
  calls["xrPathToString"] = asVoid(&pathToString);
  calls["xrEnumerateViewConfigurations"] = asVoid(&viewConfigurations);
  calls["xrGetViewConfigurationProperties"] = asVoid(&viewConfigurationProperties);
  calls["xrEnumerateViewConfigurationViews"] = asVoid(&viewConfigurationViews);
}

Runtime& runtime() {
  static Runtime the_runtime;
  return the_runtime;
}

void Runtime::say(const std::string& line) {
  if (log.is_open()) log << line << std::endl;  // complete also when the program is killed
}

XrResult Runtime::wrong(const std::string& what, XrResult result) {
  say("wrong: " + what);
  return result;
}

std::string Runtime::pathOf(XrPath path) const {
  return path == XR_NULL_PATH || path > paths.size() ? std::string() : paths[path - 1];
}

extern "C" __attribute__((visibility("default"))) XrResult xrNegotiateLoaderRuntimeInterface(
    const LoaderInfo* loader, RuntimeRequest* request) {
  if (loader == nullptr || request == nullptr || loader->type != kLoaderInfo ||
      request->type != kRuntimeRequest || loader->least_interface > 1)
    return XR_ERROR_INITIALIZATION_FAILED;
  request->interface = 1;
  request->api = XR_CURRENT_API_VERSION;
  request->calls = &getInstanceProcAddr;
  return XR_SUCCESS;
}

}  // namespace fettle::tests::xr
