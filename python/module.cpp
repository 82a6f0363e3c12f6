// The compiled part of the package fettle: scans, calls of commands, sessions. The package itself is written in Python
// (python/fettle), where its signatures and documentation are.

#include <cstdint>
#include <new>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "app/commands/typed_values.h"
#include "engine/base/job.h"
#include "engine/field/seen_field.h"
#include "engine/field/version.h"
#include "engine/filter/catalogue.h"
#include "engine/formats/formats.h"
#include "engine/io/geo/geo_reference.h"
#include "engine/io/geo/named_crs.h"
#include "python/calls.h"
#include "python/errors.h"
#include "python/scan.h"
#include "python/session_reader.h"

namespace fettle::python {

namespace py = pybind11;

namespace {

py::list formats() {
  py::list all;
  for (const engine::FormatInfo& format : engine::formats()) {
    py::list extensions;
    for (const std::string_view extension : format.extensions) extensions.append(std::string(extension));
    all.append(py::make_tuple(std::string(format.name), std::string(format.description), extensions,
                              format.reads, format.writes));
  }
  return all;
}

// The unit in which a coordinate system counts: "m", "deg"; empty where it cannot be read.
std::string unitOfCrs(const std::string& crs) {
  const engine::Result<std::string> wkt = engine::crsOf(crs);
  if (!wkt) return {};
  engine::StatedUnits units;
  std::vector<std::string> warnings;
  engine::unitsOfCrs(*wkt, 0.0, units, warnings);
  return units.lateral ? units.lateral->name : std::string();
}

std::int64_t holesOf(const Scan& scan) {
  const py::gil_scoped_release released;
  return engine::summarize(scan.data.field).no_data;
}

std::string hashOf(const Scan& scan) {
  const py::gil_scoped_release released;
  engine::JobControl job;
  const auto stored = engine::restored(scan.data.field, job);
  if (!stored) throw std::bad_alloc();
  return fmt::format("{:016x}", engine::contentHash(*stored));
}

// How far a filter reaches, at what multiples pieces begin that have the field's results [samples], and its range in
// standard deviations of the noise where it has one, else 0. Reach -1: as far as the whole field. `cutoff` and `radius` as
// typed, in mm or with a unit; empty: none.
std::tuple<std::int32_t, std::int32_t, double> reachOf(const std::string& word, double window, double passes,
                                                       const std::string& cutoff, const std::string& radius,
                                                       double spacing_x, double spacing_y,
                                                       const std::string& unit, std::int32_t columns,
                                                       std::int32_t rows) {
  const engine::Filter* const filter = engine::filterNamed(word);
  if (filter == nullptr || engine::needsWholeField(*filter)) {
    // An unknown word is refused by the filter itself.
    return {filter == nullptr ? 0 : -1, 1, 0.0};
  }
  engine::FilterSpec spec;
  spec.kind = filter->kind;
  if (filter->window.exists() && window > 0.0) spec.window = static_cast<int>(window);
  spec.passes = static_cast<int>(passes);
  const std::string& nesting = filter->nesting_word == "radius" ? radius : cutoff;
  if (filter->nesting.exists() && !nesting.empty())
    spec.nesting_mm = valueOf(app::parseHeight(nesting, engine::Grid{}, std::string(filter->nesting_word)));
  engine::Grid grid;
  grid.width = columns;
  grid.height = rows;
  grid.spacing_x = spacing_x;
  grid.spacing_y = spacing_y;
  if (const auto known = engine::lengthUnitFromName(unit)) grid.lateral_unit = *known;
  return {engine::reachOf(spec, grid, false), engine::pieceGridOf(spec, grid),
          filter->range_sigma.exists() ? filter->noises : 0.0};
}

void addScan(py::module_& module) {
  py::class_<Scan>(module, "Scan")
      .def(py::init([](const py::array_t<float>& heights, std::pair<double, double> spacing,
                       std::pair<double, double> origin, std::string unit, std::string height_unit,
                       std::string crs) {
        return scanOf(heights, {spacing, origin, std::move(unit), std::move(height_unit), std::move(crs)});
      }))
      .def("heights", heightsOf)
      .def("marks", marksOf)
      .def("with_marks", withMarks)
      .def("lines",
           [](const Scan& scan) {
             const engine::EdgeLines& lines = scan.data.field.lines();
             return lines == nullptr ? std::vector<LineRow>() : rowsOf(*lines);
           })
      .def("with_lines", withLines)
      .def("inverted",
           [](const Scan& scan) {
             Scan made = scan;
             made.data.field = scan.data.field.inverted();
             made.data.original = scan.original().inverted();
             return made;
           })
      .def("form", formOf)
      .def("samples", samplesOf)
      .def("under_form", underForm)
      .def("hash", hashOf)
      .def("holes", holesOf)
      .def("has_marks", [](const Scan& scan) { return scan.data.field.reader().root().marked_children != 0; })
      .def("with_original",
           [](const Scan& scan, const Scan& original) {
             Scan made = scan;
             made.data.original = original.data.field;
             return made;
           })
      .def("original",
           [](const Scan& scan) {
             Scan made;
             made.data.field = scan.original();
             made.data.format = scan.data.format;
             return made;
           })
      .def_property_readonly("rows", [](const Scan& scan) { return scan.grid().height; })
      .def_property_readonly("columns", [](const Scan& scan) { return scan.grid().width; })
      .def_property_readonly(
          "spacing", [](const Scan& scan) { return std::pair(scan.grid().spacing_x, scan.grid().spacing_y); })
      .def_property_readonly(
          "origin", [](const Scan& scan) { return std::pair(scan.grid().origin_x, scan.grid().origin_y); })
      .def_property_readonly("unit", [](const Scan& scan) { return scan.grid().lateral_unit.name; })
      .def_property_readonly("height_unit", [](const Scan& scan) { return scan.grid().height_unit.name; })
      .def_property_readonly("crs", [](const Scan& scan) { return scan.grid().crs_wkt; })
      .def_property_readonly("format", [](const Scan& scan) { return scan.data.format; })
      .def_property_readonly("warnings", [](const Scan& scan) { return textsOf(scan.data.warnings); })
      .def_property_readonly("gridding", [](const Scan& scan) -> py::object {
        if (!scan.data.gridding) return py::none();
        py::dict report;
        report["points"] = scan.data.gridding->points;
        report["cells"] = scan.data.gridding->cells;
        report["empty_cells"] = scan.data.gridding->empty_cells;
        report["multiple_cells"] = scan.data.gridding->multiple_cells;
        report["lattice"] = scan.data.gridding->lattice;
        return report;
      });
}

void addSession(py::module_& module) {
  py::class_<SessionReader>(module, "SessionReader")
      .def(py::init(&SessionReader::open))
      .def("steps",
           [](const SessionReader& session) {
             py::list steps;
             for (const SessionStep& step : session.steps())
               steps.append(py::make_tuple(step.number, step.name, step.kind, step.time));
             return steps;
           })
      .def("field", &SessionReader::field)
      .def("original", &SessionReader::original)
      .def_property_readonly("state", &SessionReader::state)
      .def_property_readonly("first", &SessionReader::first)
      .def_property_readonly("last", &SessionReader::last)
      .def_property_readonly("scan_path",
                             [](const SessionReader& session) { return textOf(session.scanPath()); });
}

}  // namespace

}  // namespace fettle::python

PYBIND11_MODULE(_fettle, module) {
  using namespace fettle::python;
  module.attr("version") = FETTLE_VERSION;
  addScan(module);
  addSession(module);
  module.def("formats", formats);
  module.def("reach", reachOf);
  module.def("unit_of_crs", unitOfCrs);
  module.def("tables", commandTables);
  module.def("call", callCommand);
}
