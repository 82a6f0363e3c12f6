#include "engine/io/unit_doubt.h"

#include <algorithm>
#include <array>
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

double spanMm(const Version& field) {
  const HeightBounds bounds = field.reader().bounds();
  return (double{bounds.max} - bounds.min) * field.grid().height_unit.mm;
}

// Median of |rise| over distance between neighbours of a row and of a column, on a lattice over the field;
// NaN where fewer than kFewest pairs
// of valid samples are neighbours: they prove nothing.
double medianSlope(const Version& field) {
  constexpr std::int32_t kLattice = 256;
  constexpr std::size_t kFewest = 16;
  const FieldReader reader = field.reader();
  const Grid& grid = field.grid();
  const std::int32_t by_column = grid.width / kLattice + 1;
  const std::int32_t by_row = grid.height / kLattice + 1;
  std::vector<double> slopes;
  for (std::int32_t r = 0; r < grid.height; r += by_row)
    for (std::int32_t c = 0; c < grid.width; c += by_column) {
      const double z = reader.heightAt(c, r);
      if (c + 1 < grid.width) slopes.push_back(std::abs(reader.heightAt(c + 1, r) - z) / grid.spacingXMm());
      if (r + 1 < grid.height) slopes.push_back(std::abs(reader.heightAt(c, r + 1) - z) / grid.spacingYMm());
    }
  std::erase_if(slopes, [](double slope) { return std::isnan(slope); });
  if (slopes.size() < kFewest) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
  std::nth_element(slopes.begin(), middle, slopes.end());
  return *middle * grid.height_unit.mm;
}

// The largest unit in which the surface is no steeper than 45 degrees in the middle; nothing when none is.
std::string unitFor(double slope, const LengthUnit& said) {
  for (const char* name : {"m", "cm", "mm", "um", "nm"}) {
    const auto unit = lengthUnitFromName(name);
    if (unit->mm < said.mm && slope * unit->mm / said.mm <= 1.0) return name;
  }
  return {};
}

void doubtSlopes(const Version& field, std::vector<std::string>& warnings) {
  const double slope = medianSlope(field);
  if (!(slope > kTooSteep)) return;
  const LengthUnit& said = field.grid().height_unit;
  const std::string likely = unitFor(slope, said);
  if (likely.empty())
    warnings.push_back(fmt::format(
        "heights that are no lengths in {}? Half of all neighbours rise by more than {:.0f} to 1: give the "
        "height of a count with --z-scale",
        said.name, slope));
  else
    warnings.push_back(fmt::format(
        "heights in {} where {} is said or assumed, or a spacing that is not in {}? Half of all "
        "neighbours rise by more than {:.0f} to 1: give --z-scale {:g} or --spacing",
        likely, said.name, field.grid().lateral_unit.name, slope, lengthUnitFromName(likely)->mm / said.mm));
}

}  // namespace

void doubtUnits(const Version& field, const ImportOptions& options, std::vector<std::string>& warnings) {
  const Grid& grid = field.grid();
  if (!options.z_scale && !options.spacing) doubtSlopes(field, warnings);
  const double span = spanMm(field);
  if (span > 0.0 && span < kBelowAtomsMm)
    warnings.push_back(
        fmt::format("heights in another unit than {}? They span {:.3g} nm, less than an atom: give --z-scale",
                    grid.height_unit.name, span * 1e6));
  if (span > kBeyondPlanetsMm)
    warnings.push_back(fmt::format(
        "heights in another unit than {}? They span {:.3g} km, more than on any planet: give --z-scale",
        grid.height_unit.name, span * 1e-6));
  const double extent = std::max(grid.width * grid.spacingXMm(), grid.height * grid.spacingYMm());
  if (extent > kAroundTheEarthMm)
    warnings.push_back(
        fmt::format("spacing in another unit than {}? The field is {:.3g} km long: give --spacing",
                    grid.lateral_unit.name, extent * 1e-6));
  const double closest = std::min(grid.spacingXMm(), grid.spacingYMm());
  if (closest < kClosestMm)
    warnings.push_back(
        fmt::format("spacing in another unit than {}? Samples lie {:.3g} nm apart: give --spacing",
                    grid.lateral_unit.name, closest * 1e6));
}

void doubtTexture(const Version& field, const std::string& standard, std::vector<std::string>& warnings) {
  const Grid& grid = field.grid();
  const double span = spanMm(field) / 1000.0;
  const double extent = std::max(grid.width * grid.spacingXMm(), grid.height * grid.spacingYMm()) / 1000.0;
  if (span > 1.0 || grid.spacingXMm() > 100.0 || extent > 100.0)
    warnings.push_back(fmt::format(
        "heights in micrometres in a file whose standard says {}? They span {:.3g} m over {:.3g} m: if so, "
        "give --unit um",
        standard, span, extent));
}

}  // namespace fettle::engine
