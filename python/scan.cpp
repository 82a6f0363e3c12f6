#include "python/scan.h"

#include <cmath>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include "app/commands/recipe_file.h"
#include "engine/base/job.h"
#include "engine/field/builder.h"
#include "engine/field/mark_setter.h"
#include "engine/field/nominal_form.h"
#include "engine/field/seen_field.h"
#include "engine/field/tile.h"
#include "engine/io/geo/named_crs.h"
#include "engine/io/lines/line_frame.h"
#include "engine/session/form_codec.h"
#include "python/errors.h"

namespace fettle::python {

namespace py = pybind11;

namespace {

// In the recipe of the scan.
void leaveOut(Scan& scan, const char* what) {
  engine::Imported& data = scan.data;
  if (data.steps.empty()) data.steps = data.recipe;
  data.steps += app::leftOutLine(what);
}

constexpr const char* kArray = "array";

engine::LengthUnit unitOf(const std::string& name) {
  const auto unit = engine::lengthUnitFromName(name);
  if (!unit)
    raise(engine::inputError(fmt::format("unknown unit {}", name), "unit",
                             fmt::format("take one of {}", fmt::join(engine::lengthUnitNames(), ", ")))
              .value());
  return *unit;
}

engine::Grid gridOf(py::ssize_t rows, py::ssize_t columns, const Placement& placement) {
  // A side that no field can have is refused by the builder, whatever is left of the number.
  const auto side = [](py::ssize_t n) {
    return static_cast<std::int32_t>(std::min<py::ssize_t>(n, engine::Grid::kMaxSide + 1));
  };
  engine::Grid grid;
  grid.width = side(columns);
  grid.height = side(rows);
  std::tie(grid.spacing_x, grid.spacing_y) = placement.spacing;
  std::tie(grid.origin_x, grid.origin_y) = placement.origin;
  for (const double number : {grid.origin_x, grid.origin_y})
    if (!std::isfinite(number))
      raise(engine::inputError("the origin is not finite", "origin", "give two numbers").value());
  grid.lateral_unit = unitOf(placement.unit);
  grid.height_unit = unitOf(placement.height_unit);
  if (!placement.crs.empty()) grid.crs_wkt = valueOf(engine::crsOf(placement.crs));
  return grid;
}

// f(tile row) for each, on all cores.
void forEachTileRow(std::int32_t tile_rows, const auto& f) {
  tbb::parallel_for(std::int32_t{0}, tile_rows, f);
}

engine::EdgePoint pointOf(const py::detail::unchecked_reference<double, 2>& rows, py::ssize_t r) {
  const auto rounded = [](double samples) { return std::nearbyint(samples * 0x1p20) * 0x1p-20; };
  engine::EdgePoint point;
  point.position = {rounded(rows(r, 0)), rounded(rows(r, 1))};
  point.located = true;
  if (rows.shape(1) < 9) return point;
  point.located = rows(r, 2) != 0.0;
  point.kind = rows(r, 3) != 0.0 ? engine::LineKind::kCrease : engine::LineKind::kStep;
  point.deviation = rows(r, 4);
  point.step = rows(r, 5);
  point.step_deviation = rows(r, 6);
  point.slope_change = rows(r, 7);
  point.slope_deviation = rows(r, 8);
  return point;
}

}  // namespace

Scan scanOf(const py::array_t<float>& heights, const Placement& placement) {
  if (heights.ndim() != 2)
    raise(engine::inputError(fmt::format("an array of {} dimensions is not a height field", heights.ndim()),
                             kArray, "give rows x columns")
              .value());
  const engine::Grid grid = gridOf(heights.shape(0), heights.shape(1), placement);
  const float* from = heights.data();
  const py::ssize_t stride = heights.strides(0) / static_cast<py::ssize_t>(sizeof(float));
  engine::Result<Scan> scan = [&]() -> engine::Result<Scan> {
    const py::gil_scoped_release released;
    auto builder = engine::FieldBuilder::create(grid, kArray, engine::FieldBuilder::Start::kUnwritten);
    if (!builder) return tl::unexpected(builder.error());
    constexpr std::int32_t kSide = engine::kTileSide;
    forEachTileRow((grid.height + kSide - 1) / kSide, [&](std::int32_t tr) {
      const std::int32_t row = tr * kSide;
      const std::int32_t rows = std::min(kSide, grid.height - row);
      for (std::int32_t column = 0; column < grid.width; column += kSide) {
        const std::int32_t columns = std::min(kSide, grid.width - column);
        builder->writeHeights(column, row, columns, rows, from + row * stride + column, stride);
        builder->wrote(column / kSide, tr, rows * columns);
      }
    });
    engine::Imported made;
    if (const std::int64_t infinities = builder->infinities(); infinities > 0)
      made.warnings.push_back(fmt::format("{} infinite heights are holes", infinities));
    made.format = kArray;
    made.field = std::move(*builder).build();
    return Scan{std::move(made)};
  }();
  return valueOf(std::move(scan));
}

py::array_t<float> heightsOf(const Scan& scan) {
  const engine::FieldReader field = scan.data.field.reader();
  py::array_t<float> heights({field.height(), field.width()});
  float* to = heights.mutable_data();
  const py::gil_scoped_release released;
  forEachTileRow(field.tileRows(), [&](std::int32_t tr) {
    const std::int32_t row = tr * engine::kTileSide;
    const std::int32_t rows = std::min(engine::kTileSide, field.height() - row);
    field.readHeights(0, row, field.width(), rows, to + std::ptrdiff_t{row} * field.width(), field.width());
  });
  return heights;
}

py::array_t<bool> marksOf(const Scan& scan) {
  const engine::FieldReader field = scan.data.field.reader();
  py::array_t<bool> marks({field.height(), field.width()});
  // numpy's bool is a byte of 0 or 1.
  static_assert(sizeof(bool) == 1);
  auto* to = reinterpret_cast<std::uint8_t*>(marks.mutable_data());
  const py::gil_scoped_release released;
  forEachTileRow(field.tileRows(), [&](std::int32_t tr) {
    const std::int32_t row = tr * engine::kTileSide;
    const std::int32_t rows = std::min(engine::kTileSide, field.height() - row);
    field.readMarks(0, row, field.width(), rows, to + std::ptrdiff_t{row} * field.width(), field.width());
  });
  return marks;
}

Scan withMarks(const Scan& scan, const py::array_t<bool>& marks) {
  const engine::Grid& grid = scan.grid();
  if (marks.ndim() != 2 || marks.shape(0) != grid.height || marks.shape(1) != grid.width)
    raise(engine::inputError("the marks have another shape than the field", "marks",
                             fmt::format("give {} rows and {} columns", grid.height, grid.width))
              .value());
  const auto from = marks.unchecked<2>();
  engine::Result<Scan> marked = [&]() -> engine::Result<Scan> {
    const py::gil_scoped_release released;
    engine::MarkSetter setter(scan.data.field);
    std::vector<unsigned char> mask(static_cast<std::size_t>(grid.width));
    for (std::int32_t r = grid.height - 1; r >= 0; --r) {
      for (std::int32_t c = 0; c < grid.width; ++c)
        mask[static_cast<std::size_t>(c)] = static_cast<unsigned char>(from(r, c));
      if (!setter.take(r, mask.data()))
        return engine::failure("there is not enough memory for the marks", "marks");
    }
    Scan made = scan;
    made.data.field = setter.result();
    leaveOut(made, "the marks that a program set");
    if (!made.data.original) made.data.original = scan.data.field;
    return made;
  }();
  return valueOf(std::move(marked));
}

std::vector<LineRow> rowsOf(const std::vector<engine::EdgeLine>& lines) {
  std::vector<LineRow> all;
  all.reserve(lines.size());
  for (const engine::EdgeLine& line : lines) {
    py::array_t<double> rows({static_cast<py::ssize_t>(line.points.size()), py::ssize_t{9}});
    double* to = rows.mutable_data();
    for (const engine::EdgePoint& p : line.points) {
      const double row[] = {p.position.x,          p.position.y,
                            p.located ? 1.0 : 0.0, p.kind == engine::LineKind::kCrease ? 1.0 : 0.0,
                            p.deviation,           p.step,
                            p.step_deviation,      p.slope_change,
                            p.slope_deviation};
      to = std::copy(std::begin(row), std::end(row), to);
    }
    all.emplace_back(line.id, line.closed, std::move(rows));
  }
  return all;
}

std::vector<engine::EdgeLine> linesOf(const std::vector<LineRow>& rows, const engine::Grid& grid) {
  const std::string where = "lines";
  engine::LineCollector lines(grid, where);
  for (const auto& [id, closed, points] : rows) {
    if (points.ndim() != 2 || (points.shape(1) != 2 && points.shape(1) != 9))
      raise(engine::inputError("the points of a line are not rows of column and row", where,
                               "give an array of n x 2")
                .value());
    lines.begin(id, closed);
    const auto from = points.unchecked<2>();
    for (py::ssize_t r = 0; r < points.shape(0); ++r)
      if (const auto added = lines.add(pointOf(from, r), fmt::format("line {}, point {}", id, r)); !added)
        raise(added.error());
  }
  return valueOf(lines.finish());
}

Scan withLines(const Scan& scan, const std::vector<LineRow>& rows) {
  Scan made = scan;
  leaveOut(made, "the edge lines that a program set");
  if (!made.data.original) made.data.original = scan.data.field;
  if (rows.empty()) {
    made.data.field = made.data.field.withLines(nullptr);
    return made;
  }
  auto lines = std::make_shared<const std::vector<engine::EdgeLine>>(linesOf(rows, scan.grid()));
  const py::gil_scoped_release released;
  made.data.field = made.data.field.withLines(std::move(lines));
  return made;
}

py::bytes formOf(const Scan& scan) {
  const auto* formed = scan.data.field.seenOf();
  if (formed == nullptr) return {};
  const engine::NominalForm& form = *formed->form();
  return engine::packForm(std::make_shared<const engine::NominalForm>(
      scan.data.field.reader().sign() < 0.0F ? form.inverted() : form));
}

Scan samplesOf(const Scan& scan) {
  engine::Result<Scan> samples = [&]() -> engine::Result<Scan> {
    const py::gil_scoped_release released;
    engine::JobControl job;
    auto field = engine::withoutLayer(scan.data.field, job);
    if (!field) return tl::unexpected(field.error());
    auto original = engine::withoutLayer(scan.original(), job);
    if (!original) return tl::unexpected(original.error());
    Scan made = scan;
    made.data.field = *std::move(field);
    made.data.original = *std::move(original);
    return made;
  }();
  return valueOf(std::move(samples));
}

Scan underForm(const Scan& scan, const std::string& form) {
  if (form.empty()) return scan;
  const auto unpacked = engine::unpackForm(form, scan.grid());
  if (!unpacked)
    raise(engine::inputError("these bytes are no form", "form", "give those of another field").value());
  engine::Result<Scan> seen = [&]() -> engine::Result<Scan> {
    const py::gil_scoped_release released;
    engine::JobControl job;
    const auto field = engine::SeenField::of(scan.data.field.withForm(*unpacked), job);
    if (!field) return tl::unexpected(field.error());
    auto original = engine::seenLike(scan.original(), field->seen(), job);
    if (!original) return tl::unexpected(original.error());
    Scan made = scan;
    made.data.field = field->seen();
    made.data.original = *std::move(original);
    return made;
  }();
  return valueOf(std::move(seen));
}

}  // namespace fettle::python
