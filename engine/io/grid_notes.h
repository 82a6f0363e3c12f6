#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/field/grid.h"

namespace fettle::engine {

/// What a format has no field for - units, exact spacing and origin, counts, the coordinate system - as text,
/// lines of "key = value". Formats that can carry a text of a program's own carry this one; other programs
/// pass it over.
[[nodiscard]] std::string gridNotes(const Grid& grid);

/// The grid that the text describes, without its sides; nothing if anything is missing or cannot be.
[[nodiscard]] std::optional<Grid> gridOfNotes(const std::string& text);

/// The same and the sides of the raster, for formats of points, as short lines for their comments. Without
/// the coordinate system: readers of PLY take lines of 1024 bytes at most, GDAL looks for the points of an
/// XYZ file in its first 1024.
[[nodiscard]] std::vector<std::string> rasterNotes(const Grid& grid);

/// Gathers such lines from among a file's comments.
class RasterNotesReader {
 public:
  /// A comment without its mark; whatever is no such line is passed over. Memory: under 4 KB altogether.
  void take(std::string_view comment);
  /// The raster that the comments state, sides and all; nothing if anything is missing or cannot be.
  [[nodiscard]] std::optional<Grid> raster() const;

 private:
  std::string text_;
};

}  // namespace fettle::engine
