#include "engine/io/tiff/tiff_metadata.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "engine/io/files/gdal_calls.h"
#include "engine/io/geo/geo_reference.h"

namespace fettle::engine {

namespace {

constexpr const char* kLateral = "FETTLE_LATERAL_UNIT";
constexpr const char* kCrsUnit = "FETTLE_CRS_UNIT";
constexpr const char* kNone = "none";
constexpr const char* kHeightUnitItem = "FETTLE_HEIGHT_UNIT";
constexpr const char* kPerCount = "FETTLE_HEIGHT_PER_COUNT";
constexpr const char* kOrigin = "FETTLE_ORIGIN";

// The rounding of a corner and of its conversion back to the sample, a few ulp of the larger one.
double roundingOf(double origin, double extent) {
  return 0x1p-49 * std::fmax(std::abs(origin), extent);
}

std::optional<double> positiveNumber(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value) || value <= 0.0)
    return std::nullopt;
  return value;
}

std::optional<LengthUnit> unitItem(GDALDatasetH dataset, const char* key) {
  const char* item = gdal().GDALGetMetadataItem(dataset, key, nullptr);
  if (item == nullptr) return std::nullopt;
  const std::string_view text = item;
  const std::size_t space = text.rfind(' ');
  if (space == std::string_view::npos || space == 0) return std::nullopt;
  const auto mm = positiveNumber(text.substr(space + 1));
  if (!mm) return std::nullopt;
  return LengthUnit{std::string(text.substr(0, space)), *mm};
}

// Whether the unit that was noted is that of other coordinates than the file has now. Files of earlier versions do not say
// which coordinate system they had: of degrees a length is not the unit.
bool isOfOtherCoordinates(GDALDatasetH dataset, const LengthUnit& of_crs) {
  const char* then = gdal().GDALGetMetadataItem(dataset, kCrsUnit, nullptr);
  return then != nullptr ? of_crs.name != then : of_crs.name == "deg";
}

// Degrees differ in length by their latitude.
bool isStated(const Grid& grid, const std::optional<LengthUnit>& of_crs) {
  if (!of_crs) return false;
  return of_crs->name == "deg" ? grid.lateral_unit.name == "deg" : *of_crs == grid.lateral_unit;
}

}  // namespace

void writeOwnMetadata(GDALDatasetH dataset, const Grid& grid, const std::optional<LengthUnit>& of_crs) {
  const auto text = [](const LengthUnit& unit) { return fmt::format("{} {}", unit.name, unit.mm); };
  if (!isStated(grid, of_crs)) {
    gdal().GDALSetMetadataItem(dataset, kLateral, text(grid.lateral_unit).c_str(), nullptr);
    gdal().GDALSetMetadataItem(dataset, kCrsUnit, of_crs ? of_crs->name.c_str() : kNone, nullptr);
  }
  gdal().GDALSetMetadataItem(dataset, kHeightUnitItem, text(grid.height_unit).c_str(), nullptr);
  if (grid.height_per_count > 0.0)
    gdal().GDALSetMetadataItem(dataset, kPerCount, fmt::format("{}", grid.height_per_count).c_str(), nullptr);
  const auto there = placementOf(geoTransformOf(grid), grid.width, grid.height, {});
  if (!there || there->origin_x != grid.origin_x || there->origin_y != grid.origin_y)
    gdal().GDALSetMetadataItem(dataset, kOrigin, fmt::format("{} {}", grid.origin_x, grid.origin_y).c_str(),
                               nullptr);
}

void readOwnMetadata(GDALDatasetH dataset, StatedUnits& units, Grid& grid, std::pair<double, double> spacing,
                     const std::optional<LengthUnit>& of_crs, std::vector<std::string>& warnings) {
  if (auto unit = unitItem(dataset, kLateral)) {
    if (!of_crs || !isOfOtherCoordinates(dataset, *of_crs))
      units.lateral = unit;
    else if (unit->name != of_crs->name)
      warnings.push_back(fmt::format(
          "the unit {} was noted before the file got its coordinate system, whose unit {} is taken: give "
          "--unit if that is wrong",
          unit->name, of_crs->name));
  }
  if (auto unit = unitItem(dataset, kHeightUnitItem)) units.height = unit;
  if (const char* item = gdal().GDALGetMetadataItem(dataset, kPerCount, nullptr); item != nullptr)
    grid.height_per_count = positiveNumber(item).value_or(grid.height_per_count);
  if (const char* item = gdal().GDALGetMetadataItem(dataset, kOrigin, nullptr); item != nullptr) {
    double x = 0.0, y = 0.0;
    const char* const end = item + std::strlen(item);
    const char* at = item;
    const auto number = [&](double& value) {
      const auto [stop, error] = std::from_chars(at, end, value);
      at = stop;
      return error == std::errc{};
    };
    if (number(x) && at < end && *at++ == ' ' && number(y) && at == end &&
        std::abs(x - grid.origin_x) <= roundingOf(grid.origin_x, grid.width * spacing.first) &&
        std::abs(y - grid.origin_y) <= roundingOf(grid.origin_y, grid.height * spacing.second)) {
      grid.origin_x = x;
      grid.origin_y = y;
    }
  }
}

}  // namespace fettle::engine
