#pragma once

#include <array>
#include <string>

#include "app/work/scan_reading.h"
#include "engine/base/error.h"

namespace fettle::app {

/// How a file is to be read, as a person types it: a field without text means as in the file. Threading: main.
struct ImportForm {
  std::string spacing_x, spacing_y;  ///< spacing_y empty: as spacing_x
  std::string unit;                  ///< a name that lengthUnitFromName knows
  std::string z_scale;
  std::string no_data;
  std::string cell_size;
  std::string cell_rule;              ///< "", "mean", "highest"
  std::array<std::string, 4> camera;  ///< fx, fy, cx, cy; all or none

  [[nodiscard]] static ImportForm of(const ScanOptions& options);

  /// What was typed. Errors: kInput, with the field as `where` and what it takes as the remedy.
  [[nodiscard]] engine::Result<ScanOptions> read() const;
};

}  // namespace fettle::app
