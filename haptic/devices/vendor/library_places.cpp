#include "haptic/devices/vendor/library_places.h"

#include <cstdlib>

#include <glob.h>

namespace fettle::haptic {

std::vector<std::string> libraryPlaces(const char* variable, const char* name,
                                       std::span<const char* const> patterns) {
  if (const char* const named = std::getenv(variable); named != nullptr && *named != '\0') return {named};
  std::vector<std::string> places{name};
  for (const char* const pattern : patterns) {
    glob_t found{};
    if (glob(pattern, 0, nullptr, &found) == 0)
      for (std::size_t i = 0; i < found.gl_pathc; ++i) places.emplace_back(found.gl_pathv[i]);
    globfree(&found);
  }
  return places;
}

}  // namespace fettle::haptic
