#pragma once

#include <string>

namespace fettle::tests {

/// Path of a file of the source tree, by its path from the root ("docs/formats.md").
[[nodiscard]] std::string inSourceTree(const std::string& path);

}  // namespace fettle::tests
