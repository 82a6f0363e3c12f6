#include "engine/io/mesh/mesh_sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "engine/io/field_limits.h"
#include "engine/io/points/cell_choice.h"
#include "engine/io/points/lattice.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

constexpr double kMostCellsPerCorner = 400.0;  // a mesh of few triangles has few corners on its raster
constexpr double kSmallGrid = 1e6;
// Mean number of triangles over a sample: every layer of a part counts twice.
constexpr double kMostLayers = 200.0;
constexpr double kBenefitOfDoubt = 1e7;
constexpr double kOnSide = 1e-9;  // relative distance by which a sample on a side may miss the triangle

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
};

struct Axes {
  AxisLattice x, y;
  bool raster = false;  // every corner is one of its points, except for the rounding of its coordinates
  bool stated = false;  // by the file
};

AxisLattice cellsOver(const Extent& extent, double size) {
  const double steps = std::floor((extent.high - extent.low) / size + 1e-9);
  return {extent.low, size, steps < 1e15 ? static_cast<std::int64_t>(steps) + 1 : std::int64_t{1} << 52};
}

std::vector<double> finiteOnes(const std::vector<double>& values) {
  std::vector<double> out;
  std::copy_if(values.begin(), values.end(), std::back_inserter(out),
               [](double v) { return !std::isnan(v); });
  return out;
}

Result<Axes> chooseAxes(const PointCloud& corners, const ImportOptions& options, const std::string& unit,
                        std::vector<std::string>& warnings, const std::string& path) {
  Extent ex, ey;
  double count = 0.0;
  for (std::size_t i = 0; i < corners.x.size(); ++i) {
    if (std::isnan(corners.x[i])) continue;
    ex.add(corners.x[i]);
    ey.add(corners.y[i]);
    count += 1.0;
  }
  const double width = ex.high - ex.low, height = ey.high - ey.low;
  if (!(width > 0.0 && height > 0.0) || !std::isfinite(width) || !std::isfinite(height))
    return inputError("seen from above the mesh covers no area", path, "is its height along z?");
  if (options.cell_size || options.spacing)
    return Axes{cellsOver(ex, options.cell_size ? *options.cell_size : options.spacing->first),
                cellsOver(ey, options.cell_size ? *options.cell_size : options.spacing->second)};
  if (const auto stated = statedCells(corners);
      stated && stated->count() <= std::max(kMostStatedCells, kMostCellsPerCorner * count))
    return Axes{stated->x, stated->y, true, true};
  const auto x = findAxisLattice(finiteOnes(corners.x));
  const auto y = x ? findAxisLattice(finiteOnes(corners.y)) : std::nullopt;
  if (x && y && x->count > 1 && y->count > 1 &&
      static_cast<double>(x->count) * static_cast<double>(y->count) <=
          std::max(kSmallGrid, kMostCellsPerCorner * count))
    return Axes{*x, *y, true};
  const double size = twoDigits(std::sqrt(width / count) * std::sqrt(height));
  warnings.push_back(fmt::format(
      "the corners lie on no raster, sampled from above every {} {}: --cell-size sets it", size, unit));
  return Axes{cellsOver(ex, size), cellsOver(ey, size)};
}

// One corner in samples from the lower left.
struct Corner {
  double x, y, z;
};

class Sampler {
 public:
  Sampler(std::int64_t width, std::int64_t height)
      : width_(width),
        height_(height),
        heights_(static_cast<std::size_t>(width * height), -std::numeric_limits<double>::infinity()) {}

  // Rows and samples visited when drawing, except for a few per row.
  [[nodiscard]] double costOf(const Corner& a, const Corner& b, const Corner& c) const {
    const auto within = [](double v, std::int64_t count) {
      return std::clamp(v, 0.0, static_cast<double>(count - 1));
    };
    const double rows =
        within(std::max({a.y, b.y, c.y}), height_) - within(std::min({a.y, b.y, c.y}), height_);
    const double area = std::abs((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y)) / 2.0;
    return std::min(area, rows * static_cast<double>(width_)) + rows + 1.0;
  }

  void draw(const Corner& a, const Corner& b, const Corner& c) {
    const double area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    if (area == 0.0) return;  // vertical: its sides belong to neighbours, its corners are set separately
    const std::int64_t low = first(std::min({a.y, b.y, c.y}));
    const std::int64_t high = last(std::max({a.y, b.y, c.y}), height_);
    for (std::int64_t row = low; row <= high; ++row) {
      const double py = static_cast<double>(row);
      Extent span;
      addCrossing(a, b, py, span);
      addCrossing(b, c, py, span);
      addCrossing(c, a, py, span);
      // One sample more on each side: the test below decides.
      const std::int64_t right = last(span.high + 1.0, width_);
      for (std::int64_t column = first(span.low - 1.0); column <= right; ++column) {
        const double px = static_cast<double>(column);
        // Its own corners are set without rounding, after all triangles are drawn.
        const auto here = [&](const Corner& corner) { return corner.x == px && corner.y == py; };
        if (here(a) || here(b) || here(c)) continue;
        const double wb = ((px - a.x) * (c.y - a.y) - (c.x - a.x) * (py - a.y)) / area;
        const double wc = ((b.x - a.x) * (py - a.y) - (px - a.x) * (b.y - a.y)) / area;
        if (wb < -kOnSide || wc < -kOnSide || wb + wc > 1.0 + kOnSide) continue;
        raise(column, row, a.z + wb * (b.z - a.z) + wc * (c.z - a.z));
      }
    }
  }

  // A corner that lies on a sample gives exactly its height.
  void set(const Corner& a) {
    const double column = std::nearbyint(a.x), row = std::nearbyint(a.y);
    if (std::abs(a.x - column) > 1e-6 || std::abs(a.y - row) > 1e-6 || column < 0.0 || row < 0.0 ||
        column >= static_cast<double>(width_) || row >= static_cast<double>(height_))
      return;
    double& z = at(static_cast<std::int64_t>(column), static_cast<std::int64_t>(row));
    // The interpolated height is the corner's except for rounding, or another surface above it.
    if (a.z >= z || z - a.z <= 1e-9 * std::max(std::abs(z), std::abs(a.z))) z = a.z;
  }

  [[nodiscard]] double& at(std::int64_t column, std::int64_t row) {
    return heights_[static_cast<std::size_t>(row * width_ + column)];
  }

 private:
  static constexpr double kRowTolerance =
      1e-6;  // samples by which a row may miss a corner and still touch it

  static std::int64_t first(double v) {
    return static_cast<std::int64_t>(std::ceil(std::max(v, 0.0) - kRowTolerance));
  }
  static std::int64_t last(double v, std::int64_t count) {
    return static_cast<std::int64_t>(std::floor(std::min(v, static_cast<double>(count - 1)) + kRowTolerance));
  }

  // Intersection of the row with the side from p to q; all of it when it lies along the row.
  static void addCrossing(const Corner& p, const Corner& q, double py, Extent& span) {
    if (py < std::min(p.y, q.y) - kRowTolerance || py > std::max(p.y, q.y) + kRowTolerance) return;
    if (std::abs(q.y - p.y) <= 2.0 * kRowTolerance) {
      span.add(p.x);
      span.add(q.x);
    } else {
      span.add(p.x + (q.x - p.x) * std::clamp((py - p.y) / (q.y - p.y), 0.0, 1.0));
    }
  }

  void raise(std::int64_t column, std::int64_t row, double z) {
    double& height = at(column, row);
    height = std::max(height, z);
  }

  std::int64_t width_, height_;
  std::vector<double> heights_;
};

}  // namespace

Result<Imported> sampleMesh(TriangleMesh&& mesh, const ImportOptions& options, std::string format,
                            const std::string& path, JobControl& job) {
  PointCloud& corners = mesh.corners;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle)
      if (corner >= corners.x.size())
        return inputError(fmt::format("a triangle has corner {} of {}", corner, corners.x.size()), path,
                          "the file is damaged");
  const auto gone = std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
    return std::isnan(corners.x[t[0]]) || std::isnan(corners.x[t[1]]) || std::isnan(corners.x[t[2]]);
  });
  std::vector<std::string> warnings = std::move(corners.warnings);
  if (gone != mesh.triangles.end())
    warnings.push_back(fmt::format("{} triangles have a corner that is not finite and were left out",
                                   mesh.triangles.end() - gone));
  mesh.triangles.erase(gone, mesh.triangles.end());
  if (mesh.triangles.empty()) return inputError("the file holds no triangle", path, "is this a mesh?");

  Grid grid;
  StatedUnits units;
  units.lateral = corners.unit;
  units.height = corners.height_unit;
  units.spacing = std::pair{1.0, 1.0};  // determined below, from the corners
  ImportOptions unit_only;
  unit_only.unit = options.unit;
  determineUnits(grid, units, unit_only, warnings);
  const Result<Axes> axes = chooseAxes(corners, options, grid.lateral_unit.name, warnings, path);
  if (!axes) return tl::unexpected(axes.error());
  const auto width = static_cast<std::uint64_t>(axes->x.count),
             height = static_cast<std::uint64_t>(axes->y.count);
  const std::uint64_t extra = width <= Grid::kMaxSide && height <= Grid::kMaxSide ? width * height * 8 : 0;
  if (Status fits = checkFieldSize(width, height, extra, path); !fits) {
    Error error = fits.error();
    error.remedy = "give a larger cell with --cell-size";
    return tl::unexpected(error);
  }
  placeOn(axes->x, axes->y, grid);
  if (axes->stated)
    grid.height_per_count = corners.raster->height_per_count * std::abs(options.z_scale.value_or(1.0));

  const auto corner = [&](std::uint32_t i) {
    if (axes->raster)
      return Corner{static_cast<double>(axes->x.indexOf(corners.x[i])),
                    static_cast<double>(axes->y.indexOf(corners.y[i])), corners.z[i]};
    return Corner{(corners.x[i] - grid.origin_x) / grid.spacing_x,
                  (corners.y[i] - grid.origin_y) / grid.spacing_y, corners.z[i]};
  };
  Sampler sampler(grid.width, grid.height);
  double cost = 0.0;
  for (const auto& t : mesh.triangles) cost += sampler.costOf(corner(t[0]), corner(t[1]), corner(t[2]));
  const double most = kMostLayers * static_cast<double>(grid.samples() + grid.width + grid.height) +
                      static_cast<double>(mesh.triangles.size()) + kBenefitOfDoubt;
  if (!(cost <= most))
    return inputError(fmt::format("the triangles lie {:.0f} deep over each sample, {:.0f} are allowed",
                                  cost / static_cast<double>(grid.samples()), kMostLayers),
                      path, "is this a height field? Remove the surfaces underneath");
  constexpr std::size_t kLook = 1024;
  job.begin("sampling", mesh.triangles.size() / kLook + 1);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    sampler.draw(corner(t[0]), corner(t[1]), corner(t[2]));
    if (i % kLook != kLook - 1) continue;
    job.advance();
    if (job.cancelled()) return cancelled();
  }
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t i : t) sampler.set(corner(i));

  Result<FieldBuilder> builder = FieldBuilder::create(grid, path);
  if (!builder) return tl::unexpected(builder.error());
  HeightRule rule = HeightRule::of(options);
  HeightTally tally;
  std::vector<double> row(width);
  std::vector<float> heights(width);
  for (std::int32_t r = 0; r < grid.height; ++r) {
    for (std::int32_t c = 0; c < grid.width; ++c) {
      const double z = sampler.at(c, r);
      row[static_cast<std::size_t>(c)] =
          z == -std::numeric_limits<double>::infinity() ? std::numeric_limits<double>::quiet_NaN() : z;
    }
    rule.convert(row.data(), heights.data(), width, tally);
    builder->writeHeights(0, r, grid.width, 1, heights.data(), grid.width);
  }
  tally.decimals = true;  // interpolated heights have no digits of their own
  if (job.cancelled()) return cancelled();
  warnings.push_back(fmt::format(
      "a mesh of {} triangles, sampled from above: surfaces underneath are left out", mesh.triangles.size()));
  return finishImport(std::move(*builder), rule, tally, std::move(format), std::move(warnings));
}

}  // namespace fettle::engine
