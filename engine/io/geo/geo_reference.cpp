#include "engine/io/geo/geo_reference.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "engine/io/files/gdal_calls.h"

namespace fettle::engine {

namespace {

std::ptrdiff_t digitsOf(double value) {
  std::array<char, 32> text{};
  return std::to_chars(text.data(), text.data() + text.size(), value).ptr - text.data();
}

struct DestroyCrs {
  void operator()(OGRSpatialReferenceH crs) const noexcept { gdal().OSRDestroySpatialReference(crs); }
};

// A degree of latitude and of longitude on the WGS 84 ellipsoid [m], series after Snyder, "Map Projections: A
// Working Manual" (1987), p. 24-25; other ellipsoids differ by under 0.1 %.
std::pair<double, double> degreeLengths(double latitude) {
  const double phi = latitude * std::numbers::pi / 180.0;
  const double north = 111132.954 - 559.822 * std::cos(2 * phi) + 1.175 * std::cos(4 * phi);
  const double east = 111412.84 * std::cos(phi) - 93.5 * std::cos(3 * phi) + 0.118 * std::cos(5 * phi);
  return {north, east};
}

}  // namespace

std::optional<double> cornerOf(double centre, double shift) {
  std::optional<double> best;
  double candidate = centre - shift;
  for (int i = 0; i < 4; ++i) candidate = std::nextafter(candidate, -std::numeric_limits<double>::infinity());
  for (int i = 0; i < 9; ++i) {
    if (candidate + shift == centre && (!best || digitsOf(candidate) < digitsOf(*best))) best = candidate;
    candidate = std::nextafter(candidate, std::numeric_limits<double>::infinity());
  }
  return best;
}

Result<RasterPlacement> placementOf(const GeoTransform& gt, std::int32_t width, std::int32_t height,
                                    const std::string& path) {
  for (const double number : gt)
    if (!std::isfinite(number))
      return inputError("the geo-reference holds a number that is not finite", path,
                        "repair it with gdal_edit");
  if (gt[2] != 0.0 || gt[4] != 0.0)
    return inputError("the raster is rotated or sheared", path, "straighten it first, e.g. with gdalwarp");
  if (gt[1] == 0.0 || gt[5] == 0.0)
    return inputError("the geo-reference has a pixel size of 0", path, "repair it with gdal_edit");
  RasterPlacement placement;
  placement.spacing_x = std::abs(gt[1]);
  placement.spacing_y = std::abs(gt[5]);
  placement.right_to_left = gt[1] < 0.0;
  placement.top_down = gt[5] < 0.0;
  placement.origin_x = gt[0] + (placement.right_to_left ? (width - 0.5) : 0.5) * gt[1];
  placement.origin_y = gt[3] + (placement.top_down ? (height - 0.5) : 0.5) * gt[5];
  return placement;
}

GeoTransform geoTransformOf(const Grid& grid) {
  const double shift_x = 0.5 * grid.spacing_x;
  const double shift_y = (grid.height - 0.5) * -grid.spacing_y;
  return {cornerOf(grid.origin_x, shift_x).value_or(grid.origin_x - shift_x),
          grid.spacing_x,
          0.0,
          cornerOf(grid.origin_y, shift_y).value_or(grid.origin_y - shift_y),
          0.0,
          -grid.spacing_y};
}

void unitsOfCrs(const std::string& wkt, double y, StatedUnits& units, std::vector<std::string>& warnings) {
  const std::unique_ptr<void, DestroyCrs> crs(gdal().OSRNewSpatialReference(wkt.c_str()));
  if (!crs) return;
  char* name = nullptr;  // owned by the coordinate system
  if (gdal().OSRIsGeographic(crs.get()) != 0) {
    if (std::abs(y) > 90.0) {
      warnings.push_back(fmt::format(
          "coordinates that are no degrees? The coordinate system has degrees, and the field would "
          "lie at latitude {:.8g}: metres are assumed, check the coordinate system, or give --unit",
          y));
      units.lateral = LengthUnit{"m", 1000.0};
      return;
    }
    const double latitude = std::fmin(std::abs(y), 89.0);
    const auto [north, east] = degreeLengths(latitude);
    // One unit for both axes: the geometric mean preserves areas.
    const double mean = std::sqrt(north * east);
    units.lateral = LengthUnit{"deg", mean * 1000.0};
    warnings.push_back(fmt::format(
        "coordinates are degrees: 1 deg taken as {:.0f} m at latitude {:.2f}, which is {:.1f} % too much "
        "from west to east and {:.1f} % too little from south to north, reproject to metres for true shapes",
        mean, y, 100.0 * (mean / east - 1.0), 100.0 * (1.0 - mean / north)));
  } else {
    const double metres = gdal().OSRGetLinearUnits(crs.get(), &name);
    if (std::isfinite(metres) && metres > 0.0) units.lateral = lengthUnitFromMetres(metres, name ? name : "");
  }
  if (gdal().OSRIsCompound(crs.get()) != 0 || gdal().OSRIsVertical(crs.get()) != 0) {
    name = nullptr;
    const double metres = gdal().OSRGetTargetLinearUnits(crs.get(), "VERT_CS", &name);
    if (std::isfinite(metres) && metres > 0.0 && !units.height)
      units.height = lengthUnitFromMetres(metres, name ? name : "");
  }
}

}  // namespace fettle::engine
