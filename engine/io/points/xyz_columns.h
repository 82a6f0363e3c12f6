#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "engine/field/grid.h"

namespace fettle::engine {

/// Which columns of a line hold x, y and z, from 0.
struct XyzColumns {
  std::array<std::size_t, 3> at{0, 1, 2};
  std::optional<LengthUnit> lateral, height;  ///< as a header says them: "x [mm], y [mm], z (um)"
  /// The header names all but one of the columns: the first may be an unnamed number of the row, as R writes
  /// it.
  bool one_unnamed = false;
};

/// Reads x, y and z from a line. `separator` (comma, semicolon, tab, or 0 for white space alone) may stand
/// between two fields once; a field left empty by two of them is NaN. Numbers may be in quotes, fields that
/// are not asked for may be anything. False if a field that is asked for is missing or no number.
[[nodiscard]] bool readPoint(std::string_view line, char separator, const XyzColumns& columns,
                             std::array<double, 3>& point);

/// What stands above the points of a text: lines that may be names of columns, units or a title.
class XyzHeader {
 public:
  /// A line that is no comment and holds no point, blanks in front of it included.
  void takeLine(std::string_view line);
  /// A comment without its mark.
  void takeComment(std::string_view comment);

  /// The columns by the names in the header, where that names x, y and z and `line` holds numbers there: the
  /// first line of points. The separator of the two is put into `separator`.
  [[nodiscard]] std::optional<XyzColumns> columnsOf(std::string_view line, char& separator) const;

  /// The columns where the first three of `line` are numbers, so that they would be x, y and z: those that a
  /// comment says that names x, y and z and nothing else, or as many columns as there are, else the first
  /// three. Errors (kInput): a header line that names columns and of which it is not clear which are x, y
  /// and z.
  [[nodiscard]] Result<XyzColumns> columnsBeside(std::string_view line, char separator,
                                                 const std::string& path) const;

 private:
  std::string names_, comment_;  // the lines that are taken for names; empty if there is none
  std::string units_;            // a line of units below the names
};

}  // namespace fettle::engine
