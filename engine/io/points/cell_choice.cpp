#include "engine/io/points/cell_choice.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

namespace fettle::engine {

namespace {

// With a smaller share of taken cells, the "lattice" may be the rounding of irregular coordinates.
constexpr double kLeastLatticeFill = 0.15;
constexpr double kMostPointsPerCell = 4.0;  // of a lattice, on average
constexpr double kMostCellsPerPoint = 100.0;
constexpr double kMostStatedCellsPerPoint = 1000.0;
constexpr double kGrantedCells = 1e6;  // cells that are always allowed
constexpr double kOffRaster = 0.1;     // of the spacing
constexpr double kMostSteps = 1e15;    // of an axis: far more than a field may have, and counted exactly

struct Spread {
  double low = 0.0;
  double high = 0.0;
  [[nodiscard]] double range() const { return high - low; }
};

Spread spreadOf(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return {*low, *high};
}

// Cells centred on the lowest value and every step from there.
AxisLattice cellsCentredOver(const Spread& extent, double size) {
  // In this order infinite and NaN become the bound.
  const double steps = std::min(kMostSteps, std::nearbyint(extent.range() / size));
  return {extent.low, size, static_cast<std::int64_t>(steps) + 1};
}

// Statistics of the points in the cells of two axes that fit.
struct Occupancy {
  double taken = 0.0;  // cells
  double pairs = 0.0;  // of neighbours in a row or column that are both taken
};

Occupancy occupancyOf(const PointCloud& cloud, const AxisLattice& x, const AxisLattice& y) {
  const auto width = static_cast<std::size_t>(x.count), height = static_cast<std::size_t>(y.count);
  std::vector<bool> taken(width * height);
  std::size_t cells = 0;
  for (std::size_t i = 0; i < cloud.x.size(); ++i) {
    const std::size_t k = static_cast<std::size_t>(y.indexOf(cloud.y[i])) * width +
                          static_cast<std::size_t>(x.indexOf(cloud.x[i]));
    cells += taken[k] ? 0 : 1;
    taken[k] = true;
  }
  std::size_t pairs = 0;
  for (std::size_t r = 0; r < height; ++r)
    for (std::size_t k = r * width; k < (r + 1) * width; ++k) {
      if (!taken[k]) continue;
      pairs += k + 1 < (r + 1) * width && taken[k + 1] ? 1 : 0;
      pairs += r + 1 < height && taken[k + width] ? 1 : 0;
    }
  return {static_cast<double>(cells), static_cast<double>(pairs)};
}

// Few points on many cells: a raster with many holes, or measured points whose coordinates were rounded to
// few digits, which lie on a lattice as well. Rounded points are distributed at random: some share a cell,
// N^2 / (2 cells) of N; and points that keep a distance from each other have fewer neighbours than random
// ones. Samples of a raster have a cell each.
bool isSparseRaster(const Occupancy& found, double points, double cells, const AxisLattice& x,
                    const AxisLattice& y) {
  constexpr std::int64_t kFewestTaken = 8;  // of either axis: fewer values lie on some lattice by chance
  constexpr double kShared = 0.1, kNeighbours = 0.5;  // of what random points have
  constexpr double kFewestPairs = 20.0;               // of random points, so that their absence is evidence
  const double fill = points / cells;
  const auto few = [&](const AxisLattice& axis) { return axis.taken < std::min(kFewestTaken, axis.count); };
  if (fill * kMostCellsPerPoint < 1.0 || few(x) || few(y)) return false;
  if (points - found.taken > kShared * 0.5 * points * fill) return false;
  const double random_pairs = 2.0 * points * fill;
  return random_pairs < kFewestPairs || found.pairs >= kNeighbours * random_pairs;
}

enum class Raster { kNone, kSparse, kFull };

// Whether two axes that fit make a raster of the points: no cell with many different points, and filled well
// enough. A dense cloud with one stray point far away "lies" on two positions per axis.
Raster rasterOf(const PointCloud& cloud, const AxisLattice& x, const AxisLattice& y) {
  const auto points = static_cast<double>(cloud.x.size());
  const double cells = static_cast<double>(x.count) * static_cast<double>(y.count);
  if (cells > std::max(kGrantedCells, kMostCellsPerPoint * points)) return Raster::kNone;
  const bool full = cells * kLeastLatticeFill <= points;
  // Points of one cell are equal.
  if (full && x.one_value_each && y.one_value_each) return Raster::kFull;
  const Occupancy found = occupancyOf(cloud, x, y);
  if (found.taken * kMostPointsPerCell < points) return Raster::kNone;
  if (full || found.pairs >= kLeastLatticeFill * 2.0 * found.taken) return Raster::kFull;
  return isSparseRaster(found, points, cells, x, y) ? Raster::kSparse : Raster::kNone;
}

struct FoundRaster {
  AxisLattice x, y;
  Raster kind = Raster::kNone;
};

// The widest lattices that make a raster of the points.
FoundRaster findRaster(const PointCloud& cloud) {
  constexpr std::size_t kMostFits = 3;  // of an axis; the first one is nearly always right
  AxisLatticeSearch along_x(cloud.x);
  std::vector<AxisLattice> xs, ys;
  if (auto x = along_x.next()) xs.push_back(*x);
  if (xs.empty()) return {};
  AxisLatticeSearch along_y(cloud.y);
  if (auto y = along_y.next()) ys.push_back(*y);
  if (ys.empty()) return {};
  if (const Raster kind = rasterOf(cloud, xs[0], ys[0]); kind != Raster::kNone) return {xs[0], ys[0], kind};
  const auto fill = [](AxisLatticeSearch& search, std::vector<AxisLattice>& fits) {
    while (fits.size() < kMostFits) {
      auto next = search.next();
      if (!next) return;
      fits.push_back(*next);
    }
  };
  fill(along_x, xs);
  fill(along_y, ys);
  for (const AxisLattice& x : xs)
    for (const AxisLattice& y : ys)
      if (const Raster kind = rasterOf(cloud, x, y); kind != Raster::kNone) return {x, y, kind};
  return {};
}

// Number of cells of a size that contain a point.
double occupiedCells(const PointCloud& cloud, const Spread& ex, const Spread& ey, double size) {
  std::vector<std::uint64_t> keys(cloud.x.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    keys[i] = static_cast<std::uint64_t>((cloud.x[i] - ex.low) / size) << 32 |
              static_cast<std::uint64_t>((cloud.y[i] - ey.low) / size);
  std::sort(keys.begin(), keys.end());
  return static_cast<double>(std::unique(keys.begin(), keys.end()) - keys.begin());
}

// Side of a cell for one point per cell over the area that the points cover. The covered area is counted in
// cells of the last estimate, beginning with the bounding box: each iteration removes area without points.
double estimatedCellSize(const PointCloud& cloud, const Spread& ex, const Spread& ey) {
  const auto points = static_cast<double>(cloud.x.size());
  const double longest = std::max(ex.range(), ey.range());
  if (longest == 0.0) return 1.0;
  // Along a line the length replaces the area.
  double size = std::max(std::sqrt(ex.range() / points) * std::sqrt(ey.range()), longest / points);
  for (int round = 0; round < 8; ++round) {
    if (longest / size > 4e9) break;  // keys have 32 bits per side; far above what a field can hold
    // Points at random, one per cell on average, leave 1/e of the cells empty (Poisson).
    const double covered = occupiedCells(cloud, ex, ey, size) / (1.0 - std::exp(-1.0));
    const double next = size * std::sqrt(std::min(1.0, covered / points));
    if (next > 0.9 * size) break;
    size = next;
  }
  return twoDigits(size);
}

bool liesOn(const std::vector<double>& values, const AxisLattice& axis) {
  return std::all_of(values.begin(), values.end(), [&](double v) {
    if (std::isnan(v)) return true;  // a corner of a mesh that is not finite
    const double step = (v - axis.origin) / axis.spacing;
    const double nearest = std::nearbyint(step);
    return std::abs(step - nearest) <= kOffRaster && nearest >= 0.0 &&
           nearest < static_cast<double>(axis.count);
  });
}

// The positions of an axis from the first to the last one with a value.
AxisLattice cropped(const AxisLattice& axis, const Spread& extent) {
  const std::int64_t first = axis.indexOf(extent.low), last = axis.indexOf(extent.high);
  return {axis.origin + static_cast<double>(first) * axis.spacing, axis.spacing, last - first + 1};
}

// The stated raster, without the border without points where it is too large for so few points.
std::optional<Cells> statedFor(const PointCloud& cloud, const Spread& ex, const Spread& ey,
                               std::vector<std::string>& warnings) {
  if (!cloud.raster) return std::nullopt;
  std::optional<Cells> cells = statedCells(cloud);
  if (!cells) {
    warnings.emplace_back(
        "the points do not lie on the raster that the file states, another one is searched");
    return std::nullopt;
  }
  const double most =
      std::max(kMostStatedCells, kMostStatedCellsPerPoint * static_cast<double>(cloud.x.size()));
  if (cells->count() <= most) return cells;
  cells->x = cropped(cells->x, ex);
  cells->y = cropped(cells->y, ey);
  if (cells->count() > most) return std::nullopt;
  warnings.push_back(
      fmt::format("the file states {} x {} samples for {} points: empty rows and columns at the "
                  "border were left out",
                  cloud.raster->width, cloud.raster->height, cloud.x.size()));
  return cells;
}

}  // namespace

double twoDigits(double value) {
  const std::string text = fmt::format("{:.1e}", value);
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::string thinOutRemedy(const std::string& unit) {
  return fmt::format("remove stray points or give a larger cell with --cell-size [{}]", unit);
}

std::optional<Cells> statedCells(const PointCloud& cloud) {
  if (!cloud.raster) return std::nullopt;
  const Grid& grid = *cloud.raster;
  const Cells cells{
      {grid.origin_x, grid.spacing_x, grid.width}, {grid.origin_y, grid.spacing_y, grid.height}, true, true};
  if (!liesOn(cloud.x, cells.x) || !liesOn(cloud.y, cells.y)) return std::nullopt;
  return cells;
}

Result<Cells> chooseCells(const PointCloud& cloud, const ImportOptions& options, const std::string& unit,
                          std::vector<std::string>& warnings, const std::string& path) {
  const Spread ex = spreadOf(cloud.x);
  const Spread ey = spreadOf(cloud.y);
  if (!std::isfinite(ex.range()) || !std::isfinite(ey.range()))
    return inputError("the points spread past the range of a number", path, "remove stray points");
  const auto points = static_cast<double>(cloud.x.size());
  Cells cells;
  if (options.cell_size || options.spacing) {
    cells.x = cellsCentredOver(ex, options.cell_size ? *options.cell_size : options.spacing->first);
    cells.y = cellsCentredOver(ey, options.cell_size ? *options.cell_size : options.spacing->second);
    if (cloud.raster &&
        (cells.x.spacing != cloud.raster->spacing_x || cells.y.spacing != cloud.raster->spacing_y))
      warnings.push_back(fmt::format("the file states spacing {} x {}, read as {} x {} as requested",
                                     cloud.raster->spacing_x, cloud.raster->spacing_y, cells.x.spacing,
                                     cells.y.spacing));
    return cells;
  }
  if (const auto stated = statedFor(cloud, ex, ey, warnings)) return *stated;
  if (FoundRaster raster = findRaster(cloud); raster.kind != Raster::kNone) {
    AxisLattice &x = raster.x, &y = raster.y;
    // A single row or column has no spacing across: the one along it is used, so that its cells are square.
    if (x.spacing == 0.0) x.spacing = y.spacing;
    if (y.spacing == 0.0) y.spacing = x.spacing;
    if (x.spacing == 0.0) {
      warnings.push_back(fmt::format("all points lie above each other, one cell of 1 {} is assumed", unit));
      x.spacing = y.spacing = 1.0;
    }
    cells = Cells{x, y, true};
    if (raster.kind == Raster::kSparse)
      warnings.push_back(
          fmt::format("the points lie on a raster of {} x {} {} and leave {:.3g} % of it empty: --cell-size "
                      "takes larger cells",
                      x.spacing, y.spacing, unit, 100.0 * (1.0 - points / cells.count())));
    return cells;
  }
  const double size = estimatedCellSize(cloud, ex, ey);
  cells.x = cellsCentredOver(ex, size);
  cells.y = cellsCentredOver(ey, size);
  if (cells.count() > std::max(kGrantedCells, kMostCellsPerPoint * points))
    return inputError(fmt::format("{} points spread over {:.6g} x {:.6g} {}, too thin for cells of {} {}",
                                  cloud.x.size(), ex.range(), ey.range(), unit, size, unit),
                      path, thinOutRemedy(unit));
  warnings.push_back(
      fmt::format("the points lie on no raster, cells of {} {} estimated from their density: "
                  "--cell-size sets them",
                  size, unit));
  return cells;
}

}  // namespace fettle::engine
