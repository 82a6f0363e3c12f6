#include "render/xr/xr_runtime.h"

#include <cstdlib>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace fettle::render {
namespace {

constexpr const char* kManifest = "openxr/1/active_runtime.json";

std::string setting(const char* name) {
  const char* const text = std::getenv(name);
  return text != nullptr ? text : "";
}

}  // namespace

std::vector<std::string> runtimePlaces() {
  if (const std::string named = setting("XR_RUNTIME_JSON"); !named.empty()) return {named};
  std::vector<std::string> places;
  const std::string own = setting("XDG_CONFIG_HOME"), home = setting("HOME");
  if (!own.empty())
    places.push_back(fmt::format("{}/{}", own, kManifest));
  else if (!home.empty())
    places.push_back(fmt::format("{}/.config/{}", home, kManifest));
  std::string common = setting("XDG_CONFIG_DIRS");
  if (common.empty()) common = "/etc/xdg";
  std::istringstream folders(common);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (!folder.empty()) places.push_back(fmt::format("{}/{}", folder, kManifest));
  places.push_back(fmt::format("/etc/{}", kManifest));
  return places;
}

std::string runtimeRemedy() {
  return fmt::format(
      "install the runtime of the headset (SteamVR, Monado or its maker's), start it, and choose it as the "
      "OpenXR "
      "runtime; it was looked for in {} (XR_RUNTIME_JSON names another); or leave out --xr",
      fmt::join(runtimePlaces(), ", "));
}

}  // namespace fettle::render
