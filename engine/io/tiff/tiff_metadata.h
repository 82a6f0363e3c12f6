#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/field/grid.h"
#include "engine/io/files/gdal_calls.h"
#include "engine/io/units.h"

namespace fettle::engine {

/// Properties without a GeoTIFF field, stored as metadata items of its GDAL_METADATA tag:
///   FETTLE_LATERAL_UNIT     "name mm", where the coordinate system does not state it
///   FETTLE_CRS_UNIT         beside it: the name of the unit that the coordinate system states, "none" without one
///   FETTLE_HEIGHT_UNIT      "name mm", in addition to the band's unit type, which has no size
///   FETTLE_HEIGHT_PER_COUNT Grid::height_per_count
///   FETTLE_ORIGIN           "x y", where no corner of a pixel gives the origin exactly
/// `of_crs` is the unit that the coordinate system states.
void writeOwnMetadata(GDALDatasetH dataset, const Grid& grid, const std::optional<LengthUnit>& of_crs);

/// Items that are missing or damaged have no effect. `of_crs` is the unit that the coordinate system states: another one than
/// FETTLE_CRS_UNIT was given to the file since, by a program that keeps items, and FETTLE_LATERAL_UNIT is then not that
/// of its coordinates; a warning says so. `grid` has its sides and the origin that the file's
/// reference gives, `spacing` that of the file; FETTLE_ORIGIN is used only where it is equal except for
/// rounding, so that a raster that was moved since keeps its new position.
void readOwnMetadata(GDALDatasetH dataset, StatedUnits& units, Grid& grid, std::pair<double, double> spacing,
                     const std::optional<LengthUnit>& of_crs, std::vector<std::string>& warnings);

}  // namespace fettle::engine
