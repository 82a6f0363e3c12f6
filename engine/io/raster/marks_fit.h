#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/base/error.h"
#include "engine/field/grid.h"
#include "engine/io/geo/geo_reference.h"

namespace fettle::engine {

/// The part of a raster of marks that lies on a scan, in the order in which it is stored.
struct MarksPart {
  std::int32_t first_column = 0;  ///< stored column of the scan's lowest or, right to left, highest x
  std::int32_t first_row = 0;     ///< stored row of the first of the scan's rows
  bool top_down = true;           ///< that row is the scan's highest
  bool right_to_left = false;     ///< that column is the scan's last
};

/// What a raster states about its place.
struct MarksPlace {
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::optional<GeoTransform> transform;  ///< none: pixels are the scan's samples, the top row is the highest
  std::string crs_wkt;                    ///< empty: none
};

/// Largest distance of a pixel's centre from its sample [samples]: other programs write positions with fewer digits.
inline constexpr double kMarksTolerance = 0.01;

/// Where a scan lies in a raster of marks. Without a position of the raster, or of the scan (no coordinate system, origin
/// 0, spacing 1), both must have one size. Otherwise each sample must be the centre of a pixel, to kMarksTolerance:
/// the raster may be larger than the scan, and its rows and columns may be stored in either direction.
/// Errors (kInput), `path` as place: another size; rotated, other pixels, shifted by parts of a pixel; samples that no
/// pixel covers, since they would count as not marked; another coordinate system where both state one.
/// Call during the lifetime of a GdalSession. Thread: any.
[[nodiscard]] Result<MarksPart> partOfMarks(const Grid& scan, const MarksPlace& marks,
                                            const std::string& path);

}  // namespace fettle::engine
