#include "render/xr/xr_calls.h"

#include <fmt/format.h>

#include "engine/base/loaded_library.h"

namespace fettle::render {

engine::Status XrCalls::load() {
  engine::LoadedLibrary library("libopenxr_loader.so.1", "libopenxr-loader1");
  library.find("xrGetInstanceProcAddr", GetInstanceProcAddr);
  library.find("xrEnumerateInstanceExtensionProperties", EnumerateInstanceExtensionProperties);
  library.find("xrCreateInstance", CreateInstance);
  return library.status("a headset cannot be used", "OpenXR", ", or leave out --xr");
}

engine::Status XrCalls::find(XrInstance instance) {
  std::string missing;
  const auto look = [&](const char* name, auto& call) {
    PFN_xrVoidFunction found = nullptr;
    if (GetInstanceProcAddr(instance, name, &found) != XR_SUCCESS || found == nullptr)
      missing = name;
    else
      call = reinterpret_cast<std::remove_reference_t<decltype(call)>>(found);
  };
#define FETTLE_XR_FIND(name) look("xr" #name, name);
  FETTLE_XR_CALLS(FETTLE_XR_FIND)
#undef FETTLE_XR_FIND
  if (missing.empty()) return {};
  return engine::failure(fmt::format("the headset's runtime has no {}", missing), "OpenXR",
                         "use a newer runtime");
}

std::string reasonOf(XrResult result) {
  switch (result) {
    case XR_ERROR_RUNTIME_UNAVAILABLE:
      return "no runtime is installed or running";
    case XR_ERROR_FORM_FACTOR_UNAVAILABLE:
    case XR_ERROR_FORM_FACTOR_UNSUPPORTED:
      return "no headset is connected";
    case XR_ERROR_SESSION_LOST:
    case XR_ERROR_INSTANCE_LOST:
      return "the runtime ended or the headset was unplugged";
    default:
      return fmt::format("error {}", static_cast<int>(result));
  }
}

}  // namespace fettle::render
