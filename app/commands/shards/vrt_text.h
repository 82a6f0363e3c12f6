#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/field/grid.h"

namespace fettle::app {

/// A TIFF with some rows of a field, from `row` on, counted from the lowest.
struct VrtPart {
  std::string path;
  std::int32_t row = 0, rows = 0;
};

/// A virtual raster of GDAL over files with the rows of a field, whole ones each.
[[nodiscard]] std::string vrtText(const engine::Grid& grid, const std::vector<VrtPart>& parts);

}  // namespace fettle::app
