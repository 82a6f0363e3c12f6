#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/field/grid.h"

namespace fettle::engine {

/// Properties that a format has no field for - units, exact spacing and origin, counts, the coordinate system
/// - as text, lines of "key = value". Formats that can store a program's own text store this one; other
/// programs ignore it.
[[nodiscard]] std::string gridNotes(const Grid& grid);

/// The grid that the text describes, without its sides; nothing if anything is missing or invalid.
[[nodiscard]] std::optional<Grid> gridOfNotes(const std::string& text);

/// The same with the sides of the raster, for formats of points, as short lines for their comments. Without
/// the coordinate system: readers of PLY accept lines of 1024 bytes at most, GDAL searches for the points of
/// an XYZ file in its first 1024.
[[nodiscard]] std::vector<std::string> rasterNotes(const Grid& grid);

/// Collects such lines from a file's comments.
class RasterNotesReader {
 public:
  /// A comment without its marker; other lines are ignored. Memory: under 4 KB in total.
  void take(std::string_view comment);
  /// The raster that the comments state, including sides; nothing if anything is missing or invalid.
  [[nodiscard]] std::optional<Grid> raster() const;

 private:
  std::string text_;
};

}  // namespace fettle::engine
