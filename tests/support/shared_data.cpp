#include "tests/support/shared_data.h"
#include "tests/support/source_tree.h"

#include <cstdlib>
#include <filesystem>

namespace fettle::tests {

std::optional<std::string> scan(const std::string& name) {
  const char* folder = std::getenv("FETTLE_SCANS");
  const std::filesystem::path path =
      (folder != nullptr ? std::filesystem::path(folder)
                         : std::filesystem::path(inSourceTree("../shared/data"))) /
      name;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return std::nullopt;
  return path.string();
}

}  // namespace fettle::tests
