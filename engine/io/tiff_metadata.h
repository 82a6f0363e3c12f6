#pragma once

#include <gdal.h>

#include "engine/field/grid.h"
#include "engine/io/units.h"

namespace fettle::engine {

/// What a GeoTIFF has no field for, kept as metadata items of its GDAL_METADATA tag:
///   FETTLE_LATERAL_UNIT     "name mm", where the coordinate system does not say it
///   FETTLE_HEIGHT_UNIT      "name mm", beside the band's unit type, which has no size
///   FETTLE_HEIGHT_PER_COUNT Grid::height_per_count
void writeOwnMetadata(GDALDatasetH dataset, const Grid& grid, bool lateral_unit_is_stated);

/// Items that are missing or damaged change nothing.
void readOwnMetadata(GDALDatasetH dataset, StatedUnits& units, double& height_per_count);

}  // namespace fettle::engine
