#pragma once

#include <string>

#include "engine/field/grid.h"
#include "engine/field/version.h"

namespace fettle::app {

/// What is drawn next to the field: a result, or what can be shown of it until now.
struct PreviewPicture {
  engine::Version field;
  std::string title;
};

/// "approximate, off by 12 um rms"; "off by about" where that is an estimate. `rms` in the grid's unit of height.
[[nodiscard]] std::string offText(double rms, bool estimated, const engine::Grid& grid);

}  // namespace fettle::app
