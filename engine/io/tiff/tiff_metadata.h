#pragma once

#include <utility>

#include <gdal.h>

#include "engine/field/grid.h"
#include "engine/io/units.h"

namespace fettle::engine {

/// Properties without a GeoTIFF field, stored as metadata items of its GDAL_METADATA tag:
///   FETTLE_LATERAL_UNIT     "name mm", where the coordinate system does not state it
///   FETTLE_HEIGHT_UNIT      "name mm", in addition to the band's unit type, which has no size
///   FETTLE_HEIGHT_PER_COUNT Grid::height_per_count
///   FETTLE_ORIGIN           "x y", where no corner of a pixel gives the origin exactly
void writeOwnMetadata(GDALDatasetH dataset, const Grid& grid, bool lateral_unit_is_stated);

/// Items that are missing or damaged have no effect. `grid` has its sides and the origin that the file's
/// reference gives, `spacing` that of the file; FETTLE_ORIGIN is used only where it is equal except for
/// rounding, so that a raster that was moved since keeps its new position.
void readOwnMetadata(GDALDatasetH dataset, StatedUnits& units, Grid& grid, std::pair<double, double> spacing);

}  // namespace fettle::engine
