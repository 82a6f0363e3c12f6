#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/io/import.h"

namespace fettle::app {

/// The import options that every command offers for formats that do not store these values.
struct ScanOptions {
  std::optional<double> no_data;
  std::vector<double> spacing;
  std::optional<double> z_scale;
  std::string unit;
  std::optional<double> cell_size;
  std::string cell_rule;
  std::vector<double> depth_camera;  ///< fx; fx, fy; or fx, fy, cx, cy [pixels]; empty = none
  std::string from;                  ///< format of standard input as extension; empty = by its content
};

/// Those that give `import`; `from` is empty.
[[nodiscard]] ScanOptions scanOptionsOf(const engine::ImportOptions& import);

/// The options as typed, each preceded by a blank; empty without any.
[[nodiscard]] std::string scanOptionsText(const ScanOptions& options);

/// In the importer's form. Errors: an unknown unit.
[[nodiscard]] engine::Result<engine::ImportOptions> importOptions(const ScanOptions& options);

}  // namespace fettle::app
