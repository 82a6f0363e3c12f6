#include "engine/io/points/perspective.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "engine/io/field_limits.h"
#include "engine/io/points/line_fit.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

constexpr double kPixelOff = 0.5;      // above this, the points are not those of a camera [pixels]
constexpr double kPositionOff = 0.05;  // below this, the points lie on a raster [spacings]

struct CloudFit {
  IndexLine column_by_x, row_by_y;          // a raster seen from above
  IndexLine column_by_slope, row_by_slope;  // a camera: x / z, y / z
};

CloudFit fitCloud(const PointCloud& cloud, std::uint64_t width) {
  constexpr double kFewest = 8.0;
  IndexLineFit x, y, x_slope, y_slope;
  for (std::size_t i = 0; i < cloud.z.size(); ++i) {
    if (std::isnan(cloud.z[i])) continue;
    const std::size_t whole_rows = i / width;
    const auto column = static_cast<double>(i % width), row = static_cast<double>(whole_rows);
    x.add(cloud.x[i], column);
    y.add(cloud.y[i], row);
    if (cloud.z[i] == 0.0) continue;
    x_slope.add(cloud.x[i] / cloud.z[i], column);
    y_slope.add(cloud.y[i] / cloud.z[i], row);
  }
  return {x.line(kFewest), y.line(kFewest), x_slope.line(kFewest), y_slope.line(kFewest)};
}

double medianHeight(const Version& field) {
  const Grid& grid = field.grid();
  // Every n-th row is enough for a median and needs little memory.
  const std::int32_t step = static_cast<std::int32_t>(1 + grid.samples() / 4000000);
  std::vector<float> row(static_cast<std::size_t>(grid.width)), heights;
  for (std::int32_t r = 0; r < grid.height; r += step) {
    field.reader().readHeights(0, r, grid.width, 1, row.data(), grid.width);
    std::copy_if(row.begin(), row.end(), std::back_inserter(heights), [](float z) { return !std::isnan(z); });
  }
  if (heights.empty()) return summarize(field).mean;  // only the skipped rows hold heights
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  return *middle;
}

}  // namespace

void placeInPerspective(Imported& image, const DepthCamera& camera) {
  image.in_perspective = true;
  const double distance = std::abs(medianHeight(image.field));
  Grid grid = image.field.grid();
  const std::string lateral = grid.lateral_unit.name, height = grid.height_unit.name;
  if (!(distance > 0.0)) {
    image.warnings.emplace_back("the median distance is 0, the pitch of the pixels cannot be determined");
    return;
  }
  const double in_lateral = distance * grid.height_unit.mm / grid.lateral_unit.mm;
  grid.spacing_x = in_lateral / camera.fx;
  grid.spacing_y = in_lateral / camera.fy;
  grid.origin_x = -camera.cx.value_or(0.5 * (grid.width - 1)) * grid.spacing_x;
  grid.origin_y = (camera.cy.value_or(0.5 * (grid.height - 1)) - (grid.height - 1)) * grid.spacing_y;
  image.field = image.field.withGrid(grid);
  image.warnings.push_back(fmt::format(
      "the scan keeps its camera's perspective: heights are distances from the camera, the spacing "
      "{:.6g} x {:.6g} {} is that of pixels at the median distance of {:.6g} {}",
      grid.spacing_x, grid.spacing_y, lateral, distance, height));
}

Result<Imported> gridOrganized(PointCloud&& cloud, std::uint64_t width, std::uint64_t height,
                               const ImportOptions& options, std::string format, const std::string& path,
                               JobControl& job) {
  const CloudFit fit = fitCloud(cloud, width);
  const bool raster = fit.column_by_x.rms < kPositionOff && fit.row_by_y.rms < kPositionOff;
  const bool camera = fit.column_by_slope.rms < kPixelOff && fit.row_by_slope.rms < kPixelOff;
  if (raster || !camera || options.cell_size || options.spacing) {
    cloud.dropHoles();
    return gridPoints(std::move(cloud), options, std::move(format), path, job);
  }
  if (Status fits = checkFieldSize(width, height, 0, path); !fits) return tl::unexpected(fits.error());
  std::vector<std::string> warnings = std::move(cloud.warnings);
  Grid grid;
  grid.width = static_cast<std::int32_t>(width);
  grid.height = static_cast<std::int32_t>(height);
  StatedUnits units;
  units.lateral = cloud.unit;
  units.height = cloud.height_unit;
  units.spacing = std::pair{1.0, 1.0};  // determined by placeInPerspective
  determineUnits(grid, units, options, warnings);
  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), path);
  if (!builder) return tl::unexpected(builder.error());
  HeightRule rule = HeightRule::of(options);
  HeightTally tally;
  std::vector<float> heights(width);
  for (std::uint64_t r = 0; r < height; ++r) {
    rule.convert(cloud.z.data() + r * width, heights.data(), width, tally);
    builder->writeHeights(0, static_cast<std::int32_t>(height - 1 - r), static_cast<std::int32_t>(width), 1,
                          heights.data(), static_cast<std::ptrdiff_t>(width));
  }
  tally.decimals = true;  // floats originally, or doubles of a sensor of much lower resolution
  Result<Imported> imported =
      finishImport(std::move(*builder), rule, tally, std::move(format), std::move(warnings));
  if (imported) {
    const double cx = fit.column_by_slope.offset, cy = fit.row_by_slope.offset;
    const DepthCamera fitted{std::abs(fit.column_by_slope.scale), std::abs(fit.row_by_slope.scale), cx, cy};
    imported->warnings.push_back(
        fmt::format("the points are those of a camera: fx {:.6g}, fy {:.6g}, cx {:.6g}, cy {:.6g} fitted to "
                    "{:.2g} pixels; --cell-size grids them from above instead",
                    fitted.fx, fitted.fy, cx, cy, std::max(fit.column_by_slope.rms, fit.row_by_slope.rms)));
    placeInPerspective(*imported, fitted);
  }
  return imported;
}

}  // namespace fettle::engine
