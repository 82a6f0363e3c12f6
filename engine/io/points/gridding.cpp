#include "engine/io/points/gridding.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "engine/io/field_limits.h"
#include "engine/io/points/cell_choice.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

// Height of one cell from its points, in the order of the file.
double heightOf(double* first, double* last, CellRule rule) {
  const auto n = last - first;
  switch (rule) {
    case CellRule::kHighest:
      return *std::max_element(first, last);
    case CellRule::kMean:
      return std::accumulate(first, last, 0.0) / static_cast<double>(n);
    case CellRule::kMedian:
      break;
  }
  double* middle = first + n / 2;
  std::nth_element(first, middle, last);
  // Halved before they are added: the sum of two large numbers may overflow.
  return n % 2 != 0 ? *middle : 0.5 * *middle + 0.5 * *std::max_element(first, middle);
}

}  // namespace

void PointCloud::add(double px, double py, double pz) {
  if (!std::isfinite(px) || !std::isfinite(py) || !std::isfinite(pz)) {
    if (!organized) {
      ++not_finite;
      return;
    }
    px = py = pz = std::numeric_limits<double>::quiet_NaN();
  }
  x.push_back(px);
  y.push_back(py);
  z.push_back(pz);
}

void PointCloud::dropHoles() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (std::isnan(z[i])) continue;
    x[kept] = x[i];
    y[kept] = y[i];
    z[kept++] = z[i];
  }
  for (auto* axis : {&x, &y, &z}) axis->resize(kept);
}

void PointCloud::takeRaster(const std::optional<Grid>& stated) {
  if (!stated) return;
  raster = stated;
  unit = stated->lateral_unit;
  height_unit = stated->height_unit;
}

Result<Imported> gridPoints(PointCloud&& cloud, const ImportOptions& options, std::string format,
                            const std::string& path, JobControl& job) {
  if (options.no_data) {
    HeightRule rule;
    rule.user_no_data = options.no_data;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < cloud.z.size(); ++i) {
      if (rule.hole(cloud.z[i])) continue;
      cloud.x[kept] = cloud.x[i];
      cloud.y[kept] = cloud.y[i];
      cloud.z[kept++] = cloud.z[i];
    }
    for (auto* axis : {&cloud.x, &cloud.y, &cloud.z}) axis->resize(kept);
  }
  if (cloud.x.empty())
    return inputError("the file holds no point with three finite coordinates", path,
                      "check the file and --no-data");
  std::vector<std::string> warnings = std::move(cloud.warnings);
  if (cloud.not_finite > 0)
    warnings.push_back(
        fmt::format("{} points have a coordinate that is not finite and were left out", cloud.not_finite));
  Grid grid;
  StatedUnits units;
  grid.crs_wkt = std::move(cloud.crs_wkt);
  units.lateral = cloud.unit;
  units.height = cloud.height_unit;
  units.spacing = std::pair{1.0, 1.0};  // determined below, from the points or the stated raster
  ImportOptions unit_only;
  unit_only.unit = options.unit;
  determineUnits(grid, units, unit_only, warnings);

  job.begin("gridding", 2);
  const Result<Cells> cells = chooseCells(cloud, options, grid.lateral_unit.name, warnings, path);
  if (!cells) return tl::unexpected(cells.error());
  if (job.cancelled()) return cancelled();
  job.advance();
  const auto width = static_cast<std::uint64_t>(cells->x.count);
  const auto height = static_cast<std::uint64_t>(cells->y.count);
  const std::uint64_t extra = width <= Grid::kMaxSide && height <= Grid::kMaxSide ? width * height * 8 : 0;
  if (Status s = checkFieldSize(width, height, extra + cloud.x.size() * 16, path); !s) {
    Error error = s.error();
    error.remedy = thinOutRemedy(grid.lateral_unit.name);
    return tl::unexpected(error);
  }
  placeOn(cells->x, cells->y, grid);
  if (cells->stated)
    grid.height_per_count = cloud.raster->height_per_count * std::abs(options.z_scale.value_or(1.0));

  // Points sorted by cell (a counting sort, stable): start[k] .. start[k + 1] are those of cell k.
  std::vector<std::uint64_t> cell_of(cloud.x.size());
  std::vector<std::uint64_t> start(width * height + 1, 0);
  for (std::size_t i = 0; i < cell_of.size(); ++i) {
    cell_of[i] = static_cast<std::uint64_t>(cells->y.indexOf(cloud.y[i])) * width +
                 static_cast<std::uint64_t>(cells->x.indexOf(cloud.x[i]));
    ++start[cell_of[i] + 1];
  }
  for (auto* axis : {&cloud.x, &cloud.y}) std::vector<double>().swap(*axis);
  GriddingReport report;
  report.points = static_cast<std::int64_t>(cell_of.size());
  report.cells = grid.samples();
  report.lattice = cells->lattice;
  for (std::size_t k = 1; k < start.size(); ++k) {
    report.empty_cells += start[k] == 0 ? 1 : 0;
    report.multiple_cells += start[k] > 1 ? 1 : 0;
    start[k] += start[k - 1];
  }
  std::vector<double> sorted(cell_of.size());
  for (std::size_t i = 0; i < cell_of.size(); ++i) sorted[start[cell_of[i]]++] = cloud.z[i];
  // Each start has moved to the next cell's: the begin of cell k is now start[k - 1].
  if (job.cancelled()) return cancelled();

  Result<FieldBuilder> builder = FieldBuilder::create(grid, path);
  if (!builder) return tl::unexpected(builder.error());
  HeightRule rule;
  rule.scale = options.z_scale.value_or(1.0);
  HeightTally tally;
  std::vector<double> row(width);
  std::vector<float> heights(width);
  for (std::int32_t r = 0; r < grid.height; ++r) {
    for (std::size_t c = 0; c < width; ++c) {
      const std::size_t k = static_cast<std::size_t>(r) * width + c;
      const std::size_t begin = k == 0 ? 0 : start[k - 1];
      const std::size_t end = start[k];
      row[c] = begin == end ? std::numeric_limits<double>::quiet_NaN()
                            : heightOf(sorted.data() + begin, sorted.data() + end, options.cell_rule);
    }
    rule.convert(row.data(), heights.data(), width, tally);
    builder->writeHeights(0, r, grid.width, 1, heights.data(), grid.width);
  }
  tally.said = 1;         // they were left out as points
  tally.decimals = true;  // decimal numbers, or floats originally
  job.advance();
  if (job.cancelled()) return cancelled();
  rule.user_no_data = options.no_data;  // applied already, before a cell could mix it with heights
  Result<Imported> imported =
      finishImport(std::move(*builder), rule, tally, std::move(format), std::move(warnings));
  if (imported) imported->gridding = report;
  return imported;
}

}  // namespace fettle::engine
