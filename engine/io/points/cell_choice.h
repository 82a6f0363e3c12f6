#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/io/points/gridding.h"
#include "engine/io/points/lattice.h"

namespace fettle::engine {

/// The cells in which points are collected: positions along either axis.
struct Cells {
  AxisLattice x, y;
  bool lattice = false;  ///< the points lie on them: a stated or detected raster
  bool stated = false;   ///< by the file (PointCloud::raster)

  [[nodiscard]] double count() const { return static_cast<double>(x.count) * static_cast<double>(y.count); }
};

/// The cells for a cloud, by the first of these that applies:
///
///   requested  ImportOptions::cell_size or spacing
///   stated     PointCloud::raster, where every point lies on it; its empty rows and columns at the border
///              stay, up to kMostStatedCells or 1000 cells per point, otherwise they are removed
///   found      a lattice of either axis (lattice.h) that is a raster of the points: one point per cell, and
///              either the cells around the points are taken too, or no two points share a cell where
///              random points would. At most 100 cells per point, or a million
///   estimated  square, of the size at which the area covered by the points holds one point per cell
///
/// Appends to `warnings` what was estimated or ignored. Errors (kInput): a spread past the range of a double;
/// estimated cells of over 100 per point, as caused by a stray point far away. `unit` is the lateral unit's
/// name; the cloud's points are finite and at least one.
[[nodiscard]] Result<Cells> chooseCells(const PointCloud& cloud, const ImportOptions& options,
                                        const std::string& unit, std::vector<std::string>& warnings,
                                        const std::string& path);

/// The axes of a stated raster where every point that is not NaN lies on it to a tenth of the spacing.
[[nodiscard]] std::optional<Cells> statedCells(const PointCloud& cloud);

/// Cells of a stated raster that are allowed for any number of points: 64 MB of doubles.
inline constexpr double kMostStatedCells = 8388608.0;

/// A size rounded to two digits, as used for estimates.
[[nodiscard]] double twoDigits(double value);

/// Remedy for a grid that is too large for its points.
[[nodiscard]] std::string thinOutRemedy(const std::string& unit);

}  // namespace fettle::engine
