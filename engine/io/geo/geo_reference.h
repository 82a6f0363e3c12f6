#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/field/grid.h"
#include "engine/io/units.h"

namespace fettle::engine {

/// Position of rows and columns of a stored raster, from GDAL's affine transform of pixel CORNERS
///   x = gt[0] + column * gt[1] + row * gt[2],  y = gt[3] + column * gt[4] + row * gt[5],
/// and back. A Grid is based on sample centres, from the lower left.
using GeoTransform = std::array<double, 6>;

struct RasterPlacement {
  double spacing_x = 1.0;
  double spacing_y = 1.0;
  double origin_x = 0.0;
  double origin_y = 0.0;
  bool top_down = true;        ///< the first stored row has the highest y
  bool right_to_left = false;  ///< the first stored column has the highest x
};

/// Errors (kInput): rotated or sheared (gt[2] or gt[4] not 0), a step of 0, numbers that are not finite.
[[nodiscard]] Result<RasterPlacement> placementOf(const GeoTransform& gt, std::int32_t width,
                                                  std::int32_t height, const std::string& path);

/// The transform of the field as a top-down raster. placementOf() of it returns the grid's origin
/// bit-identical; among the numbers that do, the one with the fewest digits is chosen, which is the original
/// one unless the shift by half a pixel lost digits.
[[nodiscard]] GeoTransform geoTransformOf(const Grid& grid);

/// The number c with c + shift == centre in doubles that has the fewest decimal digits; nothing if no double
/// has that property.
[[nodiscard]] std::optional<double> cornerOf(double centre, double shift);

/// Lateral and height units of a coordinate system given as WKT; `y` is a world y near the field's middle,
/// for the length of a degree. Appends to `warnings` for a geographic system. If `y` as a latitude lies
/// beyond a pole, metres are assumed.
void unitsOfCrs(const std::string& wkt, double y, StatedUnits& units, std::vector<std::string>& warnings);

}  // namespace fettle::engine
