#include "app/files/sample_part.h"

#include <filesystem>

#include "app/work/recent_files.h"
#include "engine/formats/formats.h"
#include "engine/scanner/scanner.h"

namespace fettle::app {

engine::Result<std::string> sampleScan(engine::JobControl& job) {
  const std::string folder = userFolder("XDG_DATA_HOME", ".local/share");
  if (folder.empty())
    return engine::inputError("there is no folder for a sample", "$XDG_DATA_HOME", "set it, or $HOME");
  std::string path = folder + "/sample part.tif";
  std::error_code error;
  if (std::filesystem::exists(path, error)) return path;
  engine::ScannerSpec spec;
  spec.width = 1024;
  spec.height = 1024;
  const auto scan = engine::simulateScan(spec, job);
  if (!scan) return tl::unexpected(scan.error());
  if (const auto written = engine::exportField(scan->scan, path, {}, job); !written)
    return tl::unexpected(written.error());
  return path;
}

}  // namespace fettle::app
