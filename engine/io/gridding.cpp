#include "engine/io/gridding.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "engine/io/field_limits.h"
#include "engine/io/lattice.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

constexpr double kLeastLatticeFill = 0.15;  // below, the "lattice" is the rounding of irregular coordinates
constexpr double kMostPointsACell = 4.0;    // of a lattice, on average
constexpr double kMostCellsAPoint = 100.0;
constexpr double kSmallGrid = 1e6;  // cells that are always granted

struct Cells {
  AxisLattice x, y;
  bool lattice = false;

  [[nodiscard]] double count() const { return static_cast<double>(x.count) * static_cast<double>(y.count); }
};

struct Extent {
  double low = 0.0;
  double high = 0.0;
  [[nodiscard]] double range() const { return high - low; }
};

Extent extentOf(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return {*low, *high};
}

// Cells centred on the lowest value and every step from there.
AxisLattice cellsOver(const Extent& extent, double size) {
  const double steps = std::nearbyint(extent.range() / size);
  return {extent.low, size, steps < 1e15 ? static_cast<std::int64_t>(steps) + 1 : std::int64_t{1} << 52};
}

// Whether two axes that fit make a raster of the points: filled well enough, and without a heap of different
// points in one cell. A dense cloud with one stray point far away "lies" on two positions an axis.
bool isLatticeOf(const PointCloud& cloud, const AxisLattice& x, const AxisLattice& y) {
  const auto points = static_cast<double>(cloud.x.size());
  if (static_cast<double>(x.count) * static_cast<double>(y.count) * kLeastLatticeFill > points) return false;
  if (x.one_value_each && y.one_value_each) return true;  // points of one cell are the same point
  std::vector<bool> taken(static_cast<std::size_t>(x.count * y.count));
  std::size_t cells = 0;
  for (std::size_t i = 0; i < cloud.x.size(); ++i) {
    const auto k = static_cast<std::size_t>(y.indexOf(cloud.y[i]) * x.count + x.indexOf(cloud.x[i]));
    cells += taken[k] ? 0 : 1;
    taken[k] = true;
  }
  return static_cast<double>(cells) * kMostPointsACell >= points;
}

// How many cells of a size hold a point.
double occupiedCells(const PointCloud& cloud, const Extent& ex, const Extent& ey, double size) {
  std::vector<std::uint64_t> keys(cloud.x.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    keys[i] = static_cast<std::uint64_t>((cloud.x[i] - ex.low) / size) << 32 |
              static_cast<std::uint64_t>((cloud.y[i] - ey.low) / size);
  std::sort(keys.begin(), keys.end());
  return static_cast<double>(std::unique(keys.begin(), keys.end()) - keys.begin());
}

double twoDigits(double value) {
  const std::string text = fmt::format("{:.1e}", value);
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

// Side of a cell for one point a cell over the area the points cover. The covered area is counted in cells of
// the last estimate, from the bounding box down: each round lets go of area that no point is near.
double estimatedCellSize(const PointCloud& cloud, const Extent& ex, const Extent& ey) {
  const auto points = static_cast<double>(cloud.x.size());
  const double longest = std::max(ex.range(), ey.range());
  if (longest == 0.0) return 1.0;
  // Along a line the length takes the place of the area.
  double size = std::max(std::sqrt(ex.range() / points) * std::sqrt(ey.range()), longest / points);
  for (int round = 0; round < 8; ++round) {
    if (longest / size > 4e9) break;  // keys take 32 bits a side; far past what a field can hold anyway
    // Points at random, one a cell on average, leave 1/e of the cells empty (Poisson).
    const double covered = occupiedCells(cloud, ex, ey, size) / (1.0 - std::exp(-1.0));
    const double next = size * std::sqrt(std::min(1.0, covered / points));
    if (next > 0.9 * size) break;
    size = next;
  }
  return twoDigits(size);
}

std::string remedy(const std::string& unit) {
  return fmt::format("remove stray points or give a larger cell with --cell-size [{}]", unit);
}

Result<Cells> chooseCells(const PointCloud& cloud, const ImportOptions& options, const std::string& unit,
                          std::vector<std::string>& warnings, const std::string& path) {
  const Extent ex = extentOf(cloud.x);
  const Extent ey = extentOf(cloud.y);
  if (!std::isfinite(ex.range()) || !std::isfinite(ey.range()))
    return inputError("the points spread past the range of a number", path, "remove stray points");
  const auto points = static_cast<double>(cloud.x.size());
  Cells cells;
  if (options.cell_size || options.spacing) {
    cells.x = cellsOver(ex, options.cell_size ? *options.cell_size : options.spacing->first);
    cells.y = cellsOver(ey, options.cell_size ? *options.cell_size : options.spacing->second);
    return cells;
  }
  auto x = findAxisLattice(cloud.x);
  auto y = x ? findAxisLattice(cloud.y) : std::nullopt;
  if (x && y && isLatticeOf(cloud, *x, *y)) {
    // A single row or column has no spacing across: that along it serves, so that its cells are square.
    if (x->spacing == 0.0) x->spacing = y->spacing;
    if (y->spacing == 0.0) y->spacing = x->spacing;
    if (x->spacing == 0.0) {
      warnings.push_back(fmt::format("all points lie above each other, one cell of 1 {} taken", unit));
      x->spacing = y->spacing = 1.0;
    }
    return Cells{*x, *y, true};
  }
  const double size = estimatedCellSize(cloud, ex, ey);
  cells.x = cellsOver(ex, size);
  cells.y = cellsOver(ey, size);
  if (cells.count() > std::max(kSmallGrid, kMostCellsAPoint * points))
    return inputError(fmt::format("{} points spread over {:.6g} x {:.6g} {}, too thin for cells of {} {}",
                                  cloud.x.size(), ex.range(), ey.range(), unit, size, unit),
                      path, remedy(unit));
  warnings.push_back(
      fmt::format("the points lie on no raster, cells of {} {} estimated from their density: "
                  "--cell-size sets them",
                  size, unit));
  return cells;
}

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
  units.spacing = std::pair{1.0, 1.0};  // settled below, from the points themselves
  ImportOptions unit_only;
  unit_only.unit = options.unit;
  settleUnits(grid, units, unit_only, warnings);

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
    error.remedy = remedy(grid.lateral_unit.name);
    return tl::unexpected(error);
  }
  grid.width = static_cast<std::int32_t>(width);
  grid.height = static_cast<std::int32_t>(height);
  grid.spacing_x = cells->x.spacing;
  grid.spacing_y = cells->y.spacing;
  grid.origin_x = cells->x.origin;
  grid.origin_y = cells->y.origin;

  // Points gathered by cell (a counting sort, stable): start[k] .. start[k + 1] are those of cell k.
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
  // Each start has moved to the next cell's: begin of cell k is now start[k - 1].
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
  tally.rounding = 0.0;  // decimal numbers, or floats to begin with
  job.advance();
  if (job.cancelled()) return cancelled();
  Result<Imported> imported =
      finishImport(std::move(*builder), tally, std::move(format), std::move(warnings), path);
  if (imported) imported->gridding = report;
  return imported;
}

}  // namespace fettle::engine
