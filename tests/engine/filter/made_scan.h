#pragma once

#include <functional>
#include <string>
#include <vector>

#include "engine/field/builder.h"
#include "engine/field/grid.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"
#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {

/// A scan by a formula, for a filter of which a length is given in millimetres.
struct MadeScan {
  std::string name;
  int width, height;
  double spacing_x, spacing_y;
  double nesting;                     ///< cut-off or radius [mm]
  std::function<double(int, int)> z;  ///< of column and row; NaN = hole
  double height_mm = 1.0;             ///< of its height unit
  int step = 1;                       ///< every how many results are compared with all samples
};

inline Grid gridOf(const MadeScan& scan) {
  Grid grid;
  grid.width = scan.width;
  grid.height = scan.height;
  grid.spacing_x = scan.spacing_x;
  grid.spacing_y = scan.spacing_y;
  grid.height_unit = {"unit", scan.height_mm};
  return grid;
}

inline Version versionOf(const MadeScan& scan) {
  std::vector<float> z;
  for (int r = 0; r < scan.height; ++r)
    for (int c = 0; c < scan.width; ++c) z.push_back(static_cast<float>(scan.z(c, r)));
  return makeField(gridOf(scan), z);
}

inline FilterSpec nestingSpec(FilterKind kind, double nesting) {
  FilterSpec spec;
  spec.kind = kind;
  spec.nesting_mm = nesting;
  return spec;
}

/// Row by row; NaN = hole.
inline std::vector<double> heightsOf(const Version& field) {
  const PlainField plain = toPlain(field);
  return {plain.z.begin(), plain.z.end()};
}

}  // namespace fettle::engine::tests
