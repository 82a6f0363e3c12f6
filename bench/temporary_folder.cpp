#include "bench/temporary_folder.h"

#include <cstdlib>
#include <string>
#include <system_error>

namespace fettle::bench {

namespace fs = std::filesystem;

engine::Result<TemporaryFolder> TemporaryFolder::create() {
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  if (error) return engine::inputError("there is no temporary folder", "TMPDIR", "set it to a folder");
  return create(parent);
}

engine::Result<TemporaryFolder> TemporaryFolder::create(const fs::path& parent) {
  std::string name = (parent / "fettle-bench-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    return engine::inputError("no temporary folder can be created", name,
                              "set TMPDIR to one with free space");
  return TemporaryFolder(name);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

}  // namespace fettle::bench
