#include "engine/mosaic/blended.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "engine/field/builder.h"
#include "engine/field/sample_rect.h"
#include "engine/measure/moved_onto.h"
#include "engine/mosaic/rim_map.h"

namespace fettle::engine {

namespace {

struct FlatBox {
  double left = std::numeric_limits<double>::infinity(), lower = left, right = -left, upper = -left;
  void add(double x, double y) noexcept {
    left = std::min(left, x);
    lower = std::min(lower, y);
    right = std::max(right, x);
    upper = std::max(upper, y);
  }
  void add(const FlatBox& other) noexcept {
    add(other.left, other.lower);
    add(other.right, other.upper);
  }
  [[nodiscard]] FlatBox common(const FlatBox& other) const noexcept {
    FlatBox box;
    box.left = std::max(left, other.left);
    box.lower = std::max(lower, other.lower);
    box.right = std::min(right, other.right);
    box.upper = std::min(upper, other.upper);
    return box;
  }
  [[nodiscard]] bool empty() const noexcept { return !(left <= right && lower <= upper); }
};

// Where a scan lies, seen from above: its corners at its lowest and its highest sample, which a tilt moves differently.
FlatBox boxOf(const Version& scan, const RigidMotion& pose) {
  const Grid& grid = scan.grid();
  const HeightBounds bounds = scan.reader().bounds();
  FlatBox box;
  // A spike would widen the box of a tilted scan without end: heights count as far as the scan is wide.
  const double size = std::hypot(grid.width * grid.spacingXMm(), grid.height * grid.spacingYMm());
  const double middle = pose.centre.z;
  const auto within = [&](double z) { return std::clamp(z, middle - size, middle + size); };
  for (const double x : {0.0, (grid.width - 1) * grid.spacingXMm()})
    for (const double y : {0.0, (grid.height - 1) * grid.spacingYMm()})
      for (const double z :
           {double{bounds.min} * grid.height_unit.mm, double{bounds.max} * grid.height_unit.mm}) {
        const glm::dvec3 p = pose.moved({x, y, bounds.empty() ? middle : within(z)});
        box.add(p.x, p.y);
      }
  return box;
}

// A scan in its place.
struct PlacedScan {
  MovedField moved;
  RimMap rim;
  FlatBox box;
  bool marked = false;
};

Result<std::vector<MovedField>> movedScans(const std::vector<Version>& scans, const AdjustedPoses& poses,
                                           JobControl& job) {
  std::vector<MovedField> out;
  out.reserve(scans.size());
  for (std::size_t k = 0; k < scans.size(); ++k) {
    auto moved = MovedField::create(scans[k], poses.poses[k], job);
    if (!moved) return tl::unexpected(moved.error());
    out.push_back(*std::move(moved));
  }
  return out;
}

bool markedAt(const Version& field, double x, double y) noexcept {
  const Grid& grid = field.grid();
  const auto nearest = [](double v, double spacing, std::int32_t count) {
    return std::clamp(static_cast<std::int32_t>(std::lround(v / spacing)), 0, count - 1);
  };
  return field.reader().markedAt(nearest(x, grid.spacingXMm(), grid.width),
                                 nearest(y, grid.spacingYMm(), grid.height));
}

double medianOf(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// The figures of differences, which are changed.
void takeFigures(std::vector<double>& d, OverlapDeviation& out) {
  double sum = 0.0, squares = 0.0;
  for (const double v : d) {
    sum += v;
    squares += v * v;
  }
  const auto n = static_cast<double>(d.size());
  out.places = static_cast<std::int64_t>(d.size());
  out.mean = sum / n;
  out.rms = std::sqrt(squares / n);
  out.median = medianOf(d);
  for (double& v : d) v = std::abs(v - out.median);
  constexpr double kNormal = 1.4826;
  out.spread = kNormal * medianOf(d);
}

}  // namespace

Result<std::vector<OverlapDeviation>> overlapDeviations(const std::vector<Version>& scans,
                                                        const AdjustedPoses& poses, JobControl& job) {
  constexpr int kPlaces = 256;
  constexpr std::size_t kFewest = 12;
  const auto moved = movedScans(scans, poses, job);
  if (!moved) return tl::unexpected(moved.error());
  std::vector<OverlapDeviation> out;
  for (std::size_t i = 0; i < scans.size(); ++i)
    for (std::size_t j = i + 1; j < scans.size(); ++j) {
      const FlatBox common = boxOf(scans[i], poses.poses[i]).common(boxOf(scans[j], poses.poses[j]));
      if (common.empty()) continue;
      std::vector<double> all(kPlaces * kPlaces, std::numeric_limits<double>::quiet_NaN());
      tbb::parallel_for(0, kPlaces, [&](int row) {
        for (int column = 0; column < kPlaces; ++column) {
          const double x = common.left + (column + 0.5) / kPlaces * (common.right - common.left),
                       y = common.lower + (row + 0.5) / kPlaces * (common.upper - common.lower);
          all[static_cast<std::size_t>(row * kPlaces + column)] =
              (*moved)[j].at(x, y).z - (*moved)[i].at(x, y).z;
        }
      });
      if (job.cancelled()) return cancelled();
      std::erase_if(all, [](double d) { return std::isnan(d); });
      if (all.size() < kFewest) continue;
      OverlapDeviation& one = out.emplace_back();
      one.first = i;
      one.second = j;
      takeFigures(all, one);
      one.height_error = poses.heightError(
          i, j,
          {0.5 * (common.left + common.right), 0.5 * (common.lower + common.upper), (*moved)[i].middle()});
    }
  return out;
}

Result<Grid> gridOverAll(const std::vector<Version>& scans, const AdjustedPoses& poses) {
  FlatBox all;
  for (std::size_t k = 0; k < scans.size(); ++k) all.add(boxOf(scans[k], poses.poses[k]));
  Grid grid = scans[0].grid();
  const auto sampleAt = [](double v, double spacing, auto&& rounded, double slack) {
    return static_cast<std::int64_t>(rounded(v / spacing + slack));
  };
  const auto down = [](double v) { return std::floor(v); };
  // The error of a place neither adds a row nor loses one.
  constexpr double kSlack = MovedField::kBeyond;
  const std::int64_t left = sampleAt(all.left, grid.spacingXMm(), down, 1.0 - kSlack),
                     lower = sampleAt(all.lower, grid.spacingYMm(), down, 1.0 - kSlack),
                     right = sampleAt(all.right, grid.spacingXMm(), down, kSlack),
                     upper = sampleAt(all.upper, grid.spacingYMm(), down, kSlack);
  if (right - left >= Grid::kMaxSide || upper - lower >= Grid::kMaxSide)
    return inputError(
        fmt::format("together the scans cover {} x {} samples of the first, {} a side are supported",
                    right - left + 1, upper - lower + 1, Grid::kMaxSide),
        {}, "begin with a scan of a larger spacing");
  grid.width = static_cast<std::int32_t>(right - left + 1);
  grid.height = static_cast<std::int32_t>(upper - lower + 1);
  grid.origin_x += static_cast<double>(left) * grid.spacing_x;
  grid.origin_y += static_cast<double>(lower) * grid.spacing_y;
  grid.height_per_count = 0.0;
  return grid;
}

Result<Version> blendedScans(const std::vector<Version>& scans, const AdjustedPoses& poses, const Grid& grid,
                             Blend blend, JobControl& job) try {
  auto moved = movedScans(scans, poses, job);
  if (!moved) return tl::unexpected(moved.error());
  std::vector<PlacedScan> placed;
  placed.reserve(scans.size());
  bool any_marked = false;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    auto rim = RimMap::create(scans[k], job);
    if (!rim) return tl::unexpected(rim.error());
    const bool marked = scans[k].reader().root().marked_children != 0;
    any_marked = any_marked || marked;
    placed.push_back({std::move((*moved)[k]), *std::move(rim), boxOf(scans[k], poses.poses[k]), marked});
  }
  Result<FieldBuilder> builder = FieldBuilder::create(grid, "the mosaic");
  if (!builder) return tl::unexpected(builder.error());
  // Field coordinates of the first scan, in which poses are, at the first sample of the grid.
  const Grid& first = scans[0].grid();
  const double sx = grid.spacingXMm(), sy = grid.spacingYMm();
  const double x0 = std::round((grid.origin_x - first.origin_x) / grid.spacing_x) * sx,
               y0 = std::round((grid.origin_y - first.origin_y) / grid.spacing_y) * sy;
  const TileRange tiles = allTiles(grid);
  job.begin("blending scans", static_cast<std::uint64_t>(tiles.tiles()));
  tbb::parallel_for(std::int64_t{0}, tiles.tiles(), [&](std::int64_t i) {
    if (job.cancelled()) return;
    const auto column = static_cast<std::int32_t>(i % tiles.columns) * kTileSide,
               row = static_cast<std::int32_t>(i / tiles.columns) * kTileSide;
    const std::int32_t columns = std::min(kTileSide, grid.width - column),
                       rows = std::min(kTileSide, grid.height - row);
    FlatBox here;
    here.add(x0 + (column - 1) * sx, y0 + (row - 1) * sy);
    here.add(x0 + (column + columns) * sx, y0 + (row + rows) * sy);
    double sums[kTileSamples] = {}, weights[kTileSamples] = {};
    std::uint8_t marks[kTileSamples] = {};
    for (const PlacedScan& scan : placed) {
      if (here.common(scan.box).empty()) continue;
      for (std::int32_t r = 0; r < rows; ++r)
        for (std::int32_t c = 0; c < columns; ++c) {
          const int at = r * kTileSide + c;
          if (blend == Blend::kFirst && weights[at] > 0.0) continue;
          const MovedField::Place place = scan.moved.at(x0 + (column + c) * sx, y0 + (row + r) * sy);
          if (std::isnan(place.z)) continue;
          const double weight = blend == Blend::kFade ? scan.rim.at(place.own_x, place.own_y) : 1.0;
          sums[at] += weight * place.z;
          weights[at] += weight;
          if (scan.marked && markedAt(scan.moved.field(), place.own_x, place.own_y)) marks[at] = 1;
        }
    }
    float out[kTileSamples];
    for (std::int32_t r = 0; r < rows; ++r)
      for (std::int32_t c = 0; c < columns; ++c) {
        const int at = r * kTileSide + c;
        out[at] = weights[at] > 0.0 ? static_cast<float>(sums[at] / weights[at] / grid.height_unit.mm)
                                    : std::numeric_limits<float>::quiet_NaN();
      }
    builder->writeHeights(column, row, columns, rows, out, kTileSide);
    if (any_marked) builder->writeMarks(column, row, columns, rows, marks, kTileSide);
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  return std::move(*builder).build();
} catch (const std::bad_alloc&) {
  return failure("memory is exhausted", "the mosaic", "give a folder on a disk with --store");
}

}  // namespace fettle::engine
