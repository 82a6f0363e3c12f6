#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/field/grid.h"
#include "engine/io/files/input_file.h"
#include "engine/io/import.h"

namespace fettle::engine {

/// Points as stored in a file: three arrays of one length.
struct PointCloud {
  std::vector<double> x, y, z;
  std::int64_t not_finite = 0;            ///< points left out because a coordinate is not finite
  bool organized = false;                 ///< points that are not finite are kept as NaN, and are not counted
  std::optional<LengthUnit> unit;         ///< of x, y and, unless height_unit says otherwise, z
  std::optional<LengthUnit> height_unit;  ///< of z
  std::string crs_wkt;                    ///< coordinate system of x and y; empty if none
  std::optional<Grid> raster;  ///< the raster of which the points are samples, as stated in the file
  std::vector<std::string> warnings;

  /// Adds a point, or counts it as not finite.
  void add(double px, double py, double pz);
  /// Removes the points that are not finite.
  void dropHoles();
  /// Applies the raster that a file states, units included; no effect where it states none.
  void takeRaster(const std::optional<Grid>& stated);
};

/// Makes a field of a cloud on the cells of chooseCells: each cell gets the median, mean or highest of its
/// points. Sample (c, r) is the centre of its cell.
/// Errors (kInput): no finite point; as chooseCells; a grid past Grid::kMaxSide or memory.
[[nodiscard]] Result<Imported> gridPoints(PointCloud&& cloud, const ImportOptions& options,
                                          std::string format, const std::string& path, JobControl& job);

}  // namespace fettle::engine
