#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/io/import.h"
#include "engine/io/input_file.h"

namespace fettle::engine {

/// Points as a file gives them: three arrays of one length.
struct PointCloud {
  std::vector<double> x, y, z;
  std::int64_t not_finite = 0;  ///< points left out because a coordinate is no finite number
  bool organized = false;  ///< points that are not finite stay in their place, as NaN, and are not counted
  std::optional<LengthUnit> unit;         ///< of x, y and, unless height_unit says otherwise, z
  std::optional<LengthUnit> height_unit;  ///< of z
  std::string crs_wkt;                    ///< coordinate system of x and y; empty if none
  std::vector<std::string> warnings;

  /// Takes a point, or counts it as not finite.
  void add(double px, double py, double pz);
};

/// Makes a field of a cloud: on the lattice its points lie on, else on square cells of the asked or estimated
/// size, each cell taking the median, mean or highest of its points. Sample (c, r) is the centre of its cell.
///
/// The estimate: cells of the size at which the area that the points really cover holds one point a cell.
/// Errors (kInput): no finite point; a grid past Grid::kMaxSide, memory, or (estimated) of over 100 cells a
/// point, as a stray point far away makes it: the remedy names --cell-size.
[[nodiscard]] Result<Imported> gridPoints(PointCloud&& cloud, const ImportOptions& options,
                                          std::string format, const std::string& path, JobControl& job);

}  // namespace fettle::engine
