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

/// How far what is shown of a result is, of what is in view.
struct SoFar {
  bool approximate = false;
  std::string off;         ///< offText, where it is known
  double exact = 0.0;      ///< share that has the result, 0 .. 1
  double untouched = 0.0;  ///< and of what shows the input
};
/// "40 % so far", "exact in view", "approximate, off by 12 um rms, 20 % exact, 3 % to come".
[[nodiscard]] std::string soFarText(const SoFar& so_far);

/// "approximate, off by 12 um rms"; "off by about" where that is an estimate. `rms` in the grid's unit of height.
[[nodiscard]] std::string offText(double rms, bool estimated, const engine::Grid& grid);

}  // namespace fettle::app
