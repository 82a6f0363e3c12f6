#pragma once

#include <span>
#include <string>
#include <vector>

namespace fettle::haptic {

/// Where a maker's library is looked for, in this order: the file that the environment's `variable` names, and nothing else then; the
/// dynamic loader's own places by `name`; what matches `patterns` (glob(7)), the folders where the maker's installer puts it.
[[nodiscard]] std::vector<std::string> libraryPlaces(const char* variable, const char* name,
                                                     std::span<const char* const> patterns);

}  // namespace fettle::haptic
