#pragma once

#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "engine/field/edge_line.h"
#include "engine/io/import.h"

namespace fettle::python {

/// A scan as Python holds it: what an importer gives, never changed. Threading: any thread may read one; functions that
/// take arrays hold the GIL and give it back while they copy.
struct Scan {
  engine::Imported data;

  [[nodiscard]] const engine::Grid& grid() const noexcept { return data.field.grid(); }
  [[nodiscard]] const engine::Version& original() const noexcept {
    return data.original ? *data.original : data.field;
  }
};

/// Where the samples of an array lie. Lengths in `unit`, heights in `height_unit`: names as "um".
struct Placement {
  std::pair<double, double> spacing{1.0, 1.0};  ///< x, y
  std::pair<double, double> origin{0.0, 0.0};   ///< x, y of the sample in the first column of the lowest row
  std::string unit = "mm";
  std::string height_unit = "mm";
  std::string crs;  ///< WKT; empty: none
};

/// A scan of an array of float32, rows x columns, row 0 lowest, NaN = hole, an infinity becomes one (with a warning). A row must be
/// contiguous; rows may have any distance, also a negative one. Errors: an unknown unit, not two dimensions, a spacing that is
/// not positive, no memory.
[[nodiscard]] Scan scanOf(const pybind11::array_t<float>& heights, const Placement& placement);

/// The heights as a new array, rows x columns, row 0 lowest.
[[nodiscard]] pybind11::array_t<float> heightsOf(const Scan& scan);

/// The marks as a new array of bool, in the shape of the heights.
[[nodiscard]] pybind11::array_t<bool> marksOf(const Scan& scan);

/// The scan with exactly these marks: rows x columns, any distances. Errors: another shape, no memory.
[[nodiscard]] Scan withMarks(const Scan& scan, const pybind11::array_t<bool>& marks);

/// An edge line: number, whether it is closed, and a row for each point: column, row, located, kind (0 step, 1 crease),
/// deviation, step, its deviation, change of slope, its deviation, as in engine/field/edge_line.h.
using LineRow = std::tuple<std::int64_t, bool, pybind11::array_t<double>>;

[[nodiscard]] std::vector<LineRow> rowsOf(const std::vector<engine::EdgeLine>& lines);

/// Lines of such rows, or of rows with column and row alone: points of a hand. Where points are farther apart than a
/// line allows, others are inserted between them. Errors: numbers that are not finite, points farther from the field
/// than it is long, too many points.
[[nodiscard]] std::vector<engine::EdgeLine> linesOf(const std::vector<LineRow>& rows,
                                                    const engine::Grid& grid);

/// The scan with these lines; with none of an empty list.
[[nodiscard]] Scan withLines(const Scan& scan, const std::vector<LineRow>& rows);

/// The form that lies over what the scan shows, with its sign applied, as bytes (engine/session/form_codec.h); empty: none.
[[nodiscard]] pybind11::bytes formOf(const Scan& scan);

/// The samples themselves, without any form over them. Errors: no memory.
[[nodiscard]] Scan samplesOf(const Scan& scan);

/// The scan as it is seen under a form of formOf(); itself of empty bytes. Errors: other bytes, no memory.
[[nodiscard]] Scan underForm(const Scan& scan, const std::string& form);

}  // namespace fettle::python
