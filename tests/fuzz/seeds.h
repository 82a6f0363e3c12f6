#pragma once

#include <string>
#include <utility>
#include <vector>

namespace fettle::tests {

/// Small sound files of every format that is imported: those that are written, by the exporters, the others
/// byte by byte. Pairs of extension (with the dot) and bytes. Nothing is taken from outside the project.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> fuzzSeeds();

}  // namespace fettle::tests
