#include "engine/io/unit_doubt.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "engine/io/units.h"

namespace fettle::engine {

namespace {

constexpr double kTooSteep = 10.0;
constexpr double kBelowAtomsMm = 1e-8;
constexpr double kClosestMm = 1e-9;
constexpr double kBeyondPlanetsMm = 1e8;
constexpr double kAroundTheEarthMm = 4e10;
constexpr double kRoundTheGlobe = 361.0;  // degrees, and a sample's width for rounding
constexpr double kPoleToPole = 181.0;

bool isLoneValue(const Imported& imported, float z) {
  const std::vector<LoneValue>& lone = imported.lone_values;
  return std::any_of(lone.begin(), lone.end(), [&](const LoneValue& value) { return value.height == z; });
}

double spanMm(const Imported& imported) {
  const FieldReader reader = imported.field.reader();
  const Grid& grid = imported.field.grid();
  HeightBounds bounds = reader.bounds();
  if (!imported.lone_values.empty()) {
    bounds = {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
    std::vector<float> row(static_cast<std::size_t>(grid.width));
    for (std::int32_t r = 0; r < grid.height; ++r) {
      reader.readHeights(0, r, grid.width, 1, row.data(), grid.width);
      for (const float z : row) {
        if (std::isnan(z) || isLoneValue(imported, z)) continue;
        bounds.min = std::min(bounds.min, z);
        bounds.max = std::max(bounds.max, z);
      }
    }
  }
  return bounds.empty() ? 0.0 : (double{bounds.max} - bounds.min) * grid.height_unit.mm;
}

// Median of |rise| over distance between neighbours of a row and of a column, on a lattice over the field;
// NaN where fewer than kFewest pairs of valid samples are neighbours: too few for a conclusion.
double medianSlope(const Imported& imported) {
  constexpr std::int32_t kLatticeUnits = 256;
  constexpr std::size_t kFewest = 16;
  const FieldReader reader = imported.field.reader();
  const Grid& grid = imported.field.grid();
  const auto heightAt = [&](std::int32_t c, std::int32_t r) {
    const float z = reader.heightAt(c, r);
    return isLoneValue(imported, z) ? std::numeric_limits<double>::quiet_NaN() : double{z};
  };
  const std::int32_t by_column = grid.width / kLatticeUnits + 1;
  const std::int32_t by_row = grid.height / kLatticeUnits + 1;
  std::vector<double> slopes;
  for (std::int32_t r = 0; r < grid.height; r += by_row)
    for (std::int32_t c = 0; c < grid.width; c += by_column) {
      const double z = heightAt(c, r);
      if (c + 1 < grid.width) slopes.push_back(std::abs(heightAt(c + 1, r) - z) / grid.spacingXMm());
      if (r + 1 < grid.height) slopes.push_back(std::abs(heightAt(c, r + 1) - z) / grid.spacingYMm());
    }
  std::erase_if(slopes, [](double slope) { return std::isnan(slope); });
  if (slopes.size() < kFewest) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
  std::nth_element(slopes.begin(), middle, slopes.end());
  return *middle * grid.height_unit.mm;
}

// The largest unit in which the surface is no steeper than 45 degrees in the middle; nothing when none is.
std::string unitFor(double slope, const LengthUnit& stated) {
  for (const char* name : {"m", "cm", "mm", "um", "nm"}) {
    const auto unit = lengthUnitFromName(name);
    if (unit->mm < stated.mm && slope * unit->mm / stated.mm <= 1.0) return name;
  }
  return {};
}

// Whether coordinates may be degrees although the file does not state it: they would lie on the globe, and
// not around a corner or middle of the field, or the spacing is a whole part or number of arc seconds.
bool mayBeDegrees(const Grid& grid) {
  const double extent_x = grid.width * grid.spacing_x, extent_y = grid.height * grid.spacing_y;
  const double middle_x = grid.origin_x + 0.5 * extent_x, middle_y = grid.origin_y + 0.5 * extent_y;
  const bool on_globe = std::abs(middle_y) + 0.5 * extent_y < 91.0 && grid.origin_x > -181.0 &&
                        grid.origin_x + extent_x < 361.0;
  if (!on_globe || grid.spacing_x > 1.0 || grid.spacing_y > 1.0) return false;
  const bool elsewhere = std::abs(middle_x) > extent_x || std::abs(middle_y) > extent_y;
  const bool whole_globe = extent_x > 350.0 && extent_y > 110.0;
  const auto arcSeconds = [](double spacing) {
    const double seconds = 3600.0 * spacing, whole = seconds < 1.0 ? 1.0 / seconds : seconds;
    const double thousandths = 1000.0 * spacing;  // 0.25 is a decimal number as well
    return std::abs(whole - std::nearbyint(whole)) < 1e-5 * whole &&
           std::abs(thousandths - std::nearbyint(thousandths)) > 1e-6 * thousandths;
  };
  return elsewhere || whole_globe || (arcSeconds(grid.spacing_x) && arcSeconds(grid.spacing_y));
}

// Whether degrees are possible: a length is only assumed, numbers of that size occur on the globe, and the
// spacing is not one of whole samples.
bool canBeDegrees(const Grid& grid, const ImportOptions& options) {
  if (options.unit || grid.lateral_unit != LengthUnit{}) return false;
  const double right = grid.origin_x + grid.width * grid.spacing_x;
  const double top = grid.origin_y + grid.height * grid.spacing_y;
  return grid.spacing_x < 1.0 && grid.spacing_y < 1.0 && grid.origin_x > -181.0 && right < 361.0 &&
         grid.origin_y > -91.0 && top < 91.0;
}

void doubtSlopes(Imported& imported, const ImportOptions& options) {
  std::vector<std::string>& warnings = imported.warnings;
  const Grid& grid = imported.field.grid();
  const LengthUnit& stated = grid.height_unit;
  if (isNoLength(stated.name)) return;
  const double slope = medianSlope(imported);
  if (!(slope > kTooSteep)) return;
  const std::string found = fmt::format("Half of all neighbours rise by more than {:.0f} to 1", slope);
  // The effect of a scale of heights is known only where both axes are lengths.
  if (grid.lateral_unit.name == "deg") {
    warnings.push_back(
        fmt::format("heights that are not in {}, or coordinates that are no degrees? {}, over columns {:.3g} "
                    "degrees apart: check the file's coordinate system and the unit of its heights",
                    stated.name, found, grid.spacing_x));
    return;
  }
  const std::string lies =
      fmt::format("They are {:.6g} to {:.6g}, {:.6g} to {:.6g}, {:.3g} apart. {}", grid.origin_x,
                  grid.origin_x + (grid.width - 1) * grid.spacing_x, grid.origin_y,
                  grid.origin_y + (grid.height - 1) * grid.spacing_y, grid.spacing_x, found);
  if (grid.crs_wkt.empty() && mayBeDegrees(grid)) {
    warnings.push_back(
        fmt::format("coordinates in degrees where {} is stated or assumed? {}: reproject degrees to metres, "
                    "e.g. with gdalwarp; for lengths give --spacing",
                    grid.lateral_unit.name, lies));
    return;
  }
  if (grid.crs_wkt.empty() && canBeDegrees(grid, options)) {
    warnings.push_back(
        fmt::format("coordinates in degrees, or heights in another unit than coordinates, where {0} is said "
                    "or assumed for both? {1}: reproject degrees to metres, e.g. with gdalwarp; for lengths "
                    "give --spacing in the unit of the heights",
                    grid.lateral_unit.name, lies));
    return;
  }
  if (grid.height_per_count == 1.0) {
    warnings.push_back(
        fmt::format("counts or brightness where heights in {} are stated or assumed? They come from whole "
                    "numbers. {}: if they are heights, give the height per count with --z-scale",
                    stated.name, found));
    return;
  }
  const std::string likely = unitFor(slope, stated);
  if (likely.empty())
    warnings.push_back(
        fmt::format("heights that are no lengths in {}? {}: give the height per count with --z-scale",
                    stated.name, found));
  else
    warnings.push_back(fmt::format(
        "heights in {} where {} is stated or assumed, or a spacing that is not in {}? {}: give --z-scale "
        "{:g} or --spacing",
        likely, stated.name, grid.lateral_unit.name, found, lengthUnitFromName(likely)->mm / stated.mm));
}

}  // namespace

void doubtUnits(Imported& imported, const ImportOptions& options) {
  std::vector<std::string>& warnings = imported.warnings;
  const Grid& grid = imported.field.grid();
  if (!options.z_scale && !options.spacing) doubtSlopes(imported, options);
  const double span = isNoLength(grid.height_unit.name) ? 0.0 : spanMm(imported);
  if (span > 0.0 && span < kBelowAtomsMm)
    warnings.push_back(
        fmt::format("heights in another unit than {}? They span {:.3g} nm, less than an atom: give --z-scale",
                    grid.height_unit.name, span * 1e6));
  if (span > kBeyondPlanetsMm)
    warnings.push_back(fmt::format(
        "heights in another unit than {}? They span {:.3g} km, more than on any planet: give --z-scale",
        grid.height_unit.name, span * 1e-6));
  const double across = grid.width * grid.spacing_x, down = grid.height * grid.spacing_y;
  const double extent = std::max(grid.width * grid.spacingXMm(), grid.height * grid.spacingYMm());
  if (grid.lateral_unit.name == "deg") {
    if (across > kRoundTheGlobe || down > kPoleToPole)
      warnings.push_back(
          fmt::format("coordinates that are no degrees? The field spans {:.4g} x {:.4g} of them: look at its "
                      "coordinate system",
                      across, down));
  } else if (extent > kAroundTheEarthMm) {
    warnings.push_back(
        fmt::format("spacing in another unit than {}? The field is {:.3g} km long: give --spacing",
                    grid.lateral_unit.name, extent * 1e-6));
  }
  const double closest = std::min(grid.spacingXMm(), grid.spacingYMm());
  if (closest < kClosestMm)
    warnings.push_back(
        fmt::format("spacing in another unit than {}? Samples lie {:.3g} nm apart: give --spacing",
                    grid.lateral_unit.name, closest * 1e6));
}

void doubtTexture(Imported& imported, const std::string& standard) {
  const Grid& grid = imported.field.grid();
  const double span = spanMm(imported) / 1000.0;
  const double extent = std::max(grid.width * grid.spacingXMm(), grid.height * grid.spacingYMm()) / 1000.0;
  if (span > 1.0 || grid.spacingXMm() > 100.0 || extent > 100.0)
    imported.warnings.push_back(fmt::format(
        "heights in micrometres in a file whose standard says {}? They span {:.3g} m over {:.3g} m: if so, "
        "give --unit um",
        standard, span, extent));
}

}  // namespace fettle::engine
