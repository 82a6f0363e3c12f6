#pragma once

#include <string>
#include <vector>

namespace fettle::render {

/// Where the loader looks for the file that names the runtime, in its order (OpenXR Loader - Design and Operation 1.0,
/// "Linux active runtime location"). $XR_RUNTIME_JSON replaces all others.
[[nodiscard]] std::vector<std::string> runtimePlaces();

/// What to do where there is no runtime, and where it was looked for.
[[nodiscard]] std::string runtimeRemedy();

}  // namespace fettle::render
