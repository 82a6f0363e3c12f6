#pragma once

#include <utility>

#include <gdal.h>

#include "engine/field/grid.h"
#include "engine/io/units.h"

namespace fettle::engine {

/// What a GeoTIFF has no field for, kept as metadata items of its GDAL_METADATA tag:
///   FETTLE_LATERAL_UNIT     "name mm", where the coordinate system does not say it
///   FETTLE_HEIGHT_UNIT      "name mm", beside the band's unit type, which has no size
///   FETTLE_HEIGHT_PER_COUNT Grid::height_per_count
///   FETTLE_ORIGIN           "x y", where no corner of a pixel leads to the origin's last digit
void writeOwnMetadata(GDALDatasetH dataset, const Grid& grid, bool lateral_unit_is_stated);

/// Items that are missing or damaged change nothing. `grid` has its sides and the origin that the file's
/// reference gives, `spacing` that of the file; FETTLE_ORIGIN is taken only where it is the same place but
/// for rounding, so that a raster that was moved since stays where it was moved to.
void readOwnMetadata(GDALDatasetH dataset, StatedUnits& units, Grid& grid, std::pair<double, double> spacing);

}  // namespace fettle::engine
