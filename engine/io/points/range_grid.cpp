#include "engine/io/points/range_grid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "engine/io/field_limits.h"
#include "engine/io/points/lattice.h"
#include "engine/io/points/line_fit.h"
#include "engine/io/points/perspective.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

constexpr double kOnRaster = 0.05;  // points that differ less from their places are on them [spacings]
constexpr double kCameraOff = 0.5;  // above this, it is not a camera [pixels]
constexpr double kFewestOfLine = 2.0;
constexpr double kFewestOfCamera = 8.0;

// Columns by x and rows by y, seen from above and along the rays of a camera.
struct RangeFit {
  IndexLine column, row, column_by_slope, row_by_slope;

  [[nodiscard]] bool raster() const { return column.rms < kOnRaster && row.rms < kOnRaster; }
  [[nodiscard]] bool camera() const {
    return column_by_slope.rms < kCameraOff && row_by_slope.rms < kCameraOff &&
           column_by_slope.rms + row_by_slope.rms < column.rms + row.rms;
  }
};

RangeFit fitRange(const PointCloud& cloud, const RangeGrid& grid) {
  IndexLineFit x, y, x_slope, y_slope;
  for (std::size_t i = 0; i < grid.points.size(); ++i) {
    const std::uint32_t p = grid.points[i];
    if (p == RangeGrid::kNone || std::isnan(cloud.z[p])) continue;
    const auto column = static_cast<double>(i % grid.columns), row = static_cast<double>(i / grid.columns);
    x.add(cloud.x[p], column);
    y.add(cloud.y[p], row);
    if (cloud.z[p] == 0.0) continue;
    x_slope.add(cloud.x[p] / cloud.z[p], column);
    y_slope.add(cloud.y[p] / cloud.z[p], row);
  }
  return {x.line(kFewestOfLine), y.line(kFewestOfLine), x_slope.line(kFewestOfCamera),
          y_slope.line(kFewestOfCamera)};
}

// Position of index 0, relative to the lowest coordinate, and distance of index 1 from it. A spacing of 0:
// one coordinate for all.
struct RangeAxis {
  double origin = 0.0, spacing = 0.0;
};

// `values` are coordinates, NaN for points that are not finite; `count` the places along the axis.
RangeAxis rangeAxisOf(const IndexLine& line, const std::vector<double>& values, std::uint64_t count) {
  const auto finite = std::find_if(values.begin(), values.end(), [](double v) { return !std::isnan(v); });
  if (line.scale == 0.0) return {finite == values.end() ? 0.0 : *finite, 0.0};
  const double spacing = 1.0 / std::abs(line.scale);
  // The lowest place: index 0, or the last one where the coordinate falls.
  const double lowest = line.scale > 0.0 ? 0.0 : static_cast<double>(count - 1);
  const double origin = (lowest - line.offset) / line.scale;
  if (line.rms >= kOnRaster) return {origin, spacing};
  // The numbers with the fewest digits within the accuracy of the fit.
  std::vector<double> known;
  std::copy_if(values.begin(), values.end(), std::back_inserter(known),
               [](double v) { return !std::isnan(v); });
  const auto lattice = findAxisLattice(known);
  if (!lattice || lattice->count < 2 || std::abs(lattice->spacing / spacing - 1.0) > 0.01)
    return {origin, spacing};
  return {lattice->origin + std::nearbyint((origin - lattice->origin) / lattice->spacing) * lattice->spacing,
          lattice->spacing};
}

// Descending rows and columns are reversed.
Status writePlaces(const PointCloud& cloud, const RangeGrid& grid, const RangeFit& fit,
                   const HeightRule& rule, FieldBuilder& builder, HeightTally& tally, JobControl& job) {
  std::vector<double> row(grid.columns);
  std::vector<float> heights(grid.columns);
  job.begin("gridding", grid.rows);
  for (std::uint64_t r = 0; r < grid.rows; ++r) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::uint32_t p = grid.points[r * grid.columns + c];
      row[c] = p == RangeGrid::kNone ? std::numeric_limits<double>::quiet_NaN() : cloud.z[p];
    }
    if (fit.column.scale < 0.0) std::reverse(row.begin(), row.end());
    rule.convert(row.data(), heights.data(), row.size(), tally);
    const std::uint64_t to = fit.row.scale < 0.0 ? grid.rows - 1 - r : r;
    builder.writeHeights(0, static_cast<std::int32_t>(to), static_cast<std::int32_t>(row.size()), 1,
                         heights.data(), static_cast<std::ptrdiff_t>(row.size()));
    if (job.cancelled()) return cancelled();
    job.advance();
  }
  tally.decimals = true;  // floats originally, or doubles of a sensor of much lower resolution
  return {};
}

// The camera in pixels of the field: columns from the left, rows from the top.
DepthCamera cameraOf(const RangeFit& fit, const Grid& grid) {
  DepthCamera camera{std::abs(fit.column_by_slope.scale), std::abs(fit.row_by_slope.scale),
                     fit.column_by_slope.offset, fit.row_by_slope.offset};
  if (fit.column.scale < 0.0) camera.cx = grid.width - 1 - fit.column_by_slope.offset;
  if (fit.row.scale > 0.0) camera.cy = grid.height - 1 - fit.row_by_slope.offset;
  return camera;
}

}  // namespace

Result<Imported> gridRange(PointCloud&& cloud, const RangeGrid& range, const ImportOptions& options,
                           std::string format, const std::string& path, JobControl& job) {
  for (const std::uint32_t p : range.points)
    if (p != RangeGrid::kNone && p >= cloud.z.size())
      return inputError(fmt::format("the range grid has point {} of {}", p, cloud.z.size()), path,
                        "the file is damaged");
  if (options.cell_size || options.spacing) {
    cloud.dropHoles();
    return gridPoints(std::move(cloud), options, std::move(format), path, job);
  }
  if (Status fits = checkFieldSize(range.columns, range.rows, 0, path); !fits)
    return tl::unexpected(fits.error());
  const RangeFit fit = fitRange(cloud, range);
  std::vector<std::string> warnings = std::move(cloud.warnings);
  Grid grid;
  grid.width = static_cast<std::int32_t>(range.columns);
  grid.height = static_cast<std::int32_t>(range.rows);
  StatedUnits units;
  units.lateral = cloud.unit;
  units.height = cloud.height_unit;
  units.spacing = std::pair{1.0, 1.0};  // determined below
  determineUnits(grid, units, options, warnings);
  const RangeAxis x = rangeAxisOf(fit.column, cloud.x, range.columns),
                  y = rangeAxisOf(fit.row, cloud.y, range.rows);
  // A single row or column has no spacing across: the one along it is used.
  grid.spacing_x = x.spacing > 0.0 ? x.spacing : y.spacing > 0.0 ? y.spacing : 1.0;
  grid.spacing_y = y.spacing > 0.0 ? y.spacing : grid.spacing_x;
  grid.origin_x = x.origin;
  grid.origin_y = y.origin;
  const bool finite = std::isfinite(grid.spacing_x) && std::isfinite(grid.spacing_y) &&
                      std::isfinite(grid.origin_x) && std::isfinite(grid.origin_y);
  if (!finite) return inputError("the points spread past the range of a number", path, "remove stray points");

  Result<FieldBuilder> builder = FieldBuilder::create(grid, path);
  if (!builder) return tl::unexpected(builder.error());
  HeightRule rule = HeightRule::of(options);
  HeightTally tally;
  if (Status status = writePlaces(cloud, range, fit, rule, *builder, tally, job); !status)
    return tl::unexpected(status.error());
  Result<Imported> imported =
      finishImport(std::move(*builder), rule, tally, std::move(format), std::move(warnings));
  if (!imported || fit.raster()) return imported;
  if (fit.camera()) {
    imported->warnings.push_back(
        fmt::format("the range grid is that of a camera, fitted to {:.2g} pixels; --cell-size grids its "
                    "points from above instead",
                    std::max(fit.column_by_slope.rms, fit.row_by_slope.rms)));
    placeInPerspective(*imported, cameraOf(fit, imported->field.grid()));
  } else if (x.spacing > 0.0 || y.spacing > 0.0) {
    const auto off = [](const RangeAxis& axis, const IndexLine& line) {
      return axis.spacing > 0.0 ? line.rms : 0.0;
    };
    imported->warnings.push_back(fmt::format(
        "the points of the range grid lie {:.2g} spacings off a raster: their places in the grid are kept; "
        "--cell-size grids them from above instead",
        std::max(off(x, fit.column), off(y, fit.row))));
  }
  return imported;
}

}  // namespace fettle::engine
