#pragma once

#include <cstdint>
#include <string>

namespace fettle::engine {

/// A length unit as a file names it, and its exact size. Numbers stay in the file's own unit so that a round
/// trip keeps every bit; code that needs millimetres multiplies once.
struct LengthUnit {
  std::string name = "mm";  ///< "mm", "m", "um", "nm", "ft", "ftUS", "in", "deg" (approximated, see io)
  double mm = 1.0;          ///< millimetres in one unit; finite and > 0

  friend bool operator==(const LengthUnit&, const LengthUnit&) = default;
};

/// Where the samples of a field lie.
///
/// Sample (column c, row r), 0 <= c < width, 0 <= r < height, is a point (not an area) at
///   world  x = origin_x + c * spacing_x,  y = origin_y + r * spacing_y   [lateral_unit]
///   field  x = c * spacing_x * lateral_unit.mm, y likewise, z = height * height_unit.mm   [mm]
/// Row 0 is the one with the LOWEST y, so that x, y, z is right-handed (x right, y up the picture, z towards
/// the viewer); importers of top-down formats flip rows and exporters flip them back. Haptics and render work
/// in field coordinates: local, in millimetres, so an origin 5e6 m away costs no precision.
struct Grid {
  std::int32_t width = 0;   ///< columns, 1 .. kMaxSide
  std::int32_t height = 0;  ///< rows, 1 .. kMaxSide
  double spacing_x = 1.0;   ///< [lateral_unit], finite, > 0
  double spacing_y = 1.0;   ///< [lateral_unit], finite, > 0
  double origin_x = 0.0;    ///< world x of column 0 [lateral_unit]
  double origin_y = 0.0;    ///< world y of row 0 [lateral_unit]
  LengthUnit lateral_unit;
  LengthUnit height_unit;
  std::string crs_wkt;  ///< coordinate reference system as WKT; empty if none
  /// Height of one count in the source when heights were integers times a scale (0 = not so): needed by a
  /// 16-bit export to restore the counts.
  double height_per_count = 0.0;

  /// Most samples along one side: four 8-fold levels above an 8x8 block (32768) times 8.
  static constexpr std::int32_t kMaxSide = 262144;

  [[nodiscard]] std::int64_t samples() const noexcept { return std::int64_t{width} * height; }
  [[nodiscard]] double spacingXMm() const noexcept { return spacing_x * lateral_unit.mm; }
  [[nodiscard]] double spacingYMm() const noexcept { return spacing_y * lateral_unit.mm; }
  [[nodiscard]] bool contains(std::int64_t column, std::int64_t row) const noexcept {
    return column >= 0 && row >= 0 && column < width && row < height;
  }

  friend bool operator==(const Grid&, const Grid&) = default;
};

}  // namespace fettle::engine
