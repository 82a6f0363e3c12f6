#include "tests/support/source_tree.h"

namespace fettle::tests {

// This file alone is given the root: a path of the machine in a command line makes the compiler cache useless
// elsewhere.
std::string inSourceTree(const std::string& path) {
  return std::string(FETTLE_SOURCE_DIR "/") + path;
}

}  // namespace fettle::tests
