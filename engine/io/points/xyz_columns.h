#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/error.h"
#include "engine/field/grid.h"

namespace fettle::engine {

/// Which columns of a line hold x, y and z, from 0.
struct XyzColumns {
  std::array<std::size_t, 3> at{0, 1, 2};
  std::optional<LengthUnit> lateral, height;  ///< as stated in a header: "x [mm], y [mm], z (um)"
  /// The header names all but one of the columns: the first may be an unnamed row number, as written by R.
  bool one_unnamed = false;
};

/// Reads x, y and z from a line. `separator` (comma, semicolon, tab, or 0 for only white space) may be once
/// between two fields; an empty field is NaN. Numbers may be in quotes, fields that are not requested may
/// contain anything. False if a requested field is missing or not a number.
[[nodiscard]] bool readPoint(std::string_view line, char separator, const XyzColumns& columns,
                             std::array<double, 3>& point);

/// The lines above the points of a text: names of columns, units or a title.
class XyzHeader {
 public:
  /// A line that is not a comment and holds no point, including leading blanks.
  void takeLine(std::string_view line);
  /// A comment without its marker.
  void takeComment(std::string_view comment);

  /// The columns by the names in the header, where that names x, y and z and `line`, the first line of
  /// points, holds numbers there. `separator` is set to the separator of the two.
  [[nodiscard]] std::optional<XyzColumns> columnsOf(std::string_view line, char& separator) const;

  /// The columns where the first three of `line` are numbers, so that they would be x, y and z: those of a
  /// comment that names only x, y and z, or as many columns as there are, otherwise the first three. Errors
  /// (kInput): a header line that names columns without stating clearly which are x, y and z.
  [[nodiscard]] Result<XyzColumns> columnsWithNumbers(std::string_view line, char separator,
                                                      const std::string& path) const;

 private:
  std::string names_, comment_;  // the lines used as names; empty if there is none
  std::string units_;            // a line of units below the names
};

}  // namespace fettle::engine
