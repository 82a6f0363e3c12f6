#pragma once

#include <string>

namespace fettle::app {

/// The folder "fettle" in that of the environment's `variable`, else in `under_home` of the user's home (XDG Base
/// Directory Specification); created if necessary. Empty when it cannot be created.
[[nodiscard]] std::string userFolder(const char* variable, const char* under_home);

}  // namespace fettle::app
