#include "engine/transform/resample.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <glm/geometric.hpp>

#include "engine/field/builder.h"
#include "engine/field/place_map.h"
#include "engine/field/sample_rect.h"
#include "engine/field/seen_field.h"
#include "engine/transform/form_along.h"

namespace fettle::engine {

namespace {

// And how wide kernels are there.
struct Places : PlaceMap {
  glm::dvec2 stretch{1.0};  // of the kernel along the old rows and columns, >= 1
};

Places placesOf(const Grid& old, const ResampleOptions& options, Grid& grid) {
  Places places;
  const bool area = options.method == Resampling::kArea;
  const glm::dvec2 was{old.spacing_x, old.spacing_y}, now{options.spacing_x, options.spacing_y};
  grid.spacing_x = now.x;
  grid.spacing_y = now.y;
  places.stretch = glm::max(now / was, glm::dvec2(1.0));
  // A last sample that is out by the rounding of the division is in.
  constexpr double kRounding = 1e-9;
  const double more = area ? 0.0 : 1.0;
  if (options.angle_deg == 0.0) {
    const glm::dvec2 room{(old.width - more) * was.x, (old.height - more) * was.y};
    grid.width = static_cast<std::int32_t>(
        std::clamp(std::floor(room.x / now.x + kRounding) + more, 1.0, 2.0 * Grid::kMaxSide));
    grid.height = static_cast<std::int32_t>(
        std::clamp(std::floor(room.y / now.y + kRounding) + more, 1.0, 2.0 * Grid::kMaxSide));
    if (area) {
      // The middle of the first cell; of a field smaller than a cell that of the field.
      const glm::dvec2 most = 0.5 * glm::dvec2(old.width - 1, old.height - 1);
      places.first = 0.5 * (now / was - glm::dvec2(1.0));
      if (room.x < now.x) places.first.x = most.x;
      if (room.y < now.y) places.first.y = most.y;
      grid.origin_x += places.first.x * was.x;
      grid.origin_y += places.first.y * was.y;
    }
    places.per_column = {now.x / was.x, 0.0};
    places.per_row = {0.0, now.y / was.y};
    return places;
  }
  // Lengths are the same along both axes, so that a turn is one.
  const double angle = options.angle_deg * std::numbers::pi / 180.0, c = std::cos(angle), s = std::sin(angle);
  const double wide = (old.width - more) * was.x, high = (old.height - more) * was.y;
  const double new_wide = wide * std::abs(c) + high * std::abs(s),
               new_high = wide * std::abs(s) + high * std::abs(c);
  grid.width = static_cast<std::int32_t>(
      std::clamp(std::ceil(new_wide / now.x - kRounding) + more, 1.0, 2.0 * Grid::kMaxSide));
  grid.height = static_cast<std::int32_t>(
      std::clamp(std::ceil(new_high / now.y - kRounding) + more, 1.0, 2.0 * Grid::kMaxSide));
  const glm::dvec2 middle{0.5 * (old.width - 1), 0.5 * (old.height - 1)};
  const glm::dvec2 new_middle{0.5 * (grid.width - 1), 0.5 * (grid.height - 1)};
  grid.origin_x = old.origin_x + middle.x * was.x - new_middle.x * now.x;
  grid.origin_y = old.origin_y + middle.y * was.y - new_middle.y * now.y;
  grid.crs_wkt.clear();
  // Back by the angle.
  places.per_column = glm::dvec2(c, -s) * now.x / was;
  places.per_row = glm::dvec2(s, c) * now.y / was;
  places.first = middle - new_middle.x * places.per_column - new_middle.y * places.per_row;
  return places;
}

// Weights of the old samples first, first + 1 ... along one axis.
struct Taps {
  std::int32_t first = 0;
  std::vector<double> weights;
};

double keys(double t) {
  t = std::abs(t);
  if (t < 1.0) return (1.5 * t - 2.5) * t * t + 1.0;
  if (t < 2.0) return ((-0.5 * t + 2.5) * t - 4.0) * t + 2.0;
  return 0.0;
}

double reachOf(Resampling method, double stretch) {
  return method == Resampling::kArea     ? 0.5 * stretch + 0.5
         : method == Resampling::kLinear ? stretch
                                         : 2.0 * stretch;
}

void tapsAt(double x, double stretch, Resampling method, Taps& taps) {
  const double reach = reachOf(method, stretch);
  taps.first = static_cast<std::int32_t>(std::ceil(x - reach));
  const auto last = static_cast<std::int32_t>(std::floor(x + reach));
  taps.weights.clear();
  for (std::int32_t i = taps.first; i <= last; ++i) {
    const double d = i - x;
    if (method == Resampling::kArea)
      taps.weights.push_back(
          std::max(0.0, std::min(d + 0.5, 0.5 * stretch) - std::max(d - 0.5, -0.5 * stretch)));
    else if (method == Resampling::kLinear)
      taps.weights.push_back(std::max(0.0, 1.0 - std::abs(d) / stretch));
    else
      taps.weights.push_back(keys(d / stretch));
  }
}

// Old samples around new ones, copied once for a block of these.
class OldSamples {
 public:
  void read(const FieldReader& field, std::int32_t left, std::int32_t low, std::int32_t columns,
            std::int32_t rows) {
    left_ = left;
    low_ = low;
    columns_ = columns;
    const auto n = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    heights_.resize(n);
    marks_.resize(n);
    field.readHeights(left, low, columns, rows, heights_.data(), columns);
    field.readMarks(left, low, columns, rows, marks_.data(), columns);
  }
  [[nodiscard]] float height(std::int32_t c, std::int32_t r) const { return heights_[at(c, r)]; }
  [[nodiscard]] bool marked(std::int32_t c, std::int32_t r) const { return marks_[at(c, r)] != 0; }

 private:
  [[nodiscard]] std::size_t at(std::int32_t c, std::int32_t r) const {
    return static_cast<std::size_t>(r - low_) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(c - left_);
  }
  std::int32_t left_ = 0, low_ = 0, columns_ = 0;
  std::vector<float> heights_;
  std::vector<std::uint8_t> marks_;
};

// One new sample after the other; its own for each thread's block.
class Sampler {
 public:
  Sampler(const OldSamples& old, const Grid& field, Resampling method, const glm::dvec2& stretch)
      : old_(old), field_(field), method_(method), stretch_(stretch) {}

  [[nodiscard]] float heightAt(const glm::dvec2& p) {
    constexpr float kHole = std::numeric_limits<float>::quiet_NaN();
    const auto column = static_cast<std::int32_t>(std::floor(p.x + 0.5)),
               row = static_cast<std::int32_t>(std::floor(p.y + 0.5));
    if (!field_.contains(column, row)) return kHole;
    // One cell of many samples is not known or unknown by the sample in its middle.
    const bool by_share = method_ == Resampling::kArea && std::max(stretch_.x, stretch_.y) > 1.0;
    const float nearest = old_.height(column, row);
    if (std::isnan(nearest) && !by_share) return kHole;
    const double base = std::isnan(nearest) ? anyHeightAround(p) : nearest;
    Mean mean = meanAround(p, method_, base);
    if (by_share && !(mean.known >= kLeastKnown)) return kHole;
    if (!mean.complete && method_ == Resampling::kCubic) mean = meanAround(p, Resampling::kLinear, base);
    // The mean is the surface's height where its samples lie on average, beside the place where some of them are missing or the
    // kernel is symmetric about no sample: from there along the slope.
    constexpr double kHere = 1e-9;  // samples: rounding
    if (std::max(std::abs(mean.away.x), std::abs(mean.away.y)) > kHere)
      mean.height -= glm::dot(slopeAround(p, base), mean.away);
    return static_cast<float>(base + mean.height);
  }

  [[nodiscard]] bool markedAt(const glm::dvec2& p) const {
    const auto c1 = static_cast<std::int32_t>(std::floor(p.x + 0.5 * stretch_.x));
    const auto r1 = static_cast<std::int32_t>(std::floor(p.y + 0.5 * stretch_.y));
    for (auto r = static_cast<std::int32_t>(std::ceil(p.y - 0.5 * stretch_.y)); r <= r1; ++r)
      for (auto c = static_cast<std::int32_t>(std::ceil(p.x - 0.5 * stretch_.x)); c <= c1; ++c)
        if (old_.marked(c, r)) return true;
    return false;
  }

 private:
  // Of the samples that a kernel sees; heights about a base, which keeps the digits of those far from 0.
  struct Mean {
    double height = 0.0;
    glm::dvec2 away{0.0};   // where they lie on average, from the place of the kernel [samples]
    bool complete = false;  // all have heights; of kCubic the rest counts only then
    double known = 0.0;     // share of the weights in the field that is of samples with a height
  };
  // Half, but for rounding. Smooth rims of holes then keep their places, and dropouts of less than half a cell make no hole.
  static constexpr double kLeastKnown = 0.5 - 1e-9;

  // Calls f(weight, from the place, height about `base`) for each sample of a kernel, NaN for one without a height.
  template <class F>
  void eachAround(const glm::dvec2& p, const glm::dvec2& stretch, Resampling method, double base, F&& f) {
    tapsAt(p.x, stretch.x, method, x_);
    tapsAt(p.y, stretch.y, method, y_);
    for (std::size_t r = 0; r < y_.weights.size(); ++r)
      for (std::size_t c = 0; c < x_.weights.size(); ++c) {
        const double weight = x_.weights[c] * y_.weights[r];
        if (weight == 0.0) continue;
        const std::int32_t column = x_.first + static_cast<std::int32_t>(c),
                           row = y_.first + static_cast<std::int32_t>(r);
        f(weight, glm::dvec2(column, row) - p, static_cast<double>(old_.height(column, row)) - base);
      }
  }

  [[nodiscard]] Mean meanAround(const glm::dvec2& p, Resampling method, double base) {
    Mean mean{.complete = true};
    double weights = 0.0, missing = 0.0;
    eachAround(p, stretch_, method, base, [&](double weight, const glm::dvec2& from, double z) {
      if (std::isnan(z)) {
        mean.complete = false;
        const glm::dvec2 at = glm::round(p + from);
        if (field_.contains(static_cast<std::int32_t>(at.x), static_cast<std::int32_t>(at.y)))
          missing += weight;
        return;
      }
      mean.height += weight * z;
      mean.away += weight * from;
      weights += weight;
    });
    mean.height /= weights;
    mean.away /= weights;
    mean.known = weights / (weights + missing);
    return mean;
  }

  // Of the samples that the kernel sees; NaN without one.
  [[nodiscard]] double anyHeightAround(const glm::dvec2& p) {
    double any = std::numeric_limits<double>::quiet_NaN();
    eachAround(p, stretch_, method_, 0.0, [&](double, const glm::dvec2&, double z) {
      if (std::isnan(any)) any = z;
    });
    return any;
  }

  // Of the plane through the samples of a triangle that is a sample wider, by weighted least squares; along a direction in which
  // all lie at one place there is none.
  [[nodiscard]] glm::dvec2 slopeAround(const glm::dvec2& p, double base) {
    double n = 0.0, z1 = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    glm::dvec2 middle{0.0}, by{0.0};
    const auto each = [&](auto&& take) {
      eachAround(p, stretch_ + 1.0, Resampling::kLinear, base,
                 [&](double weight, const glm::dvec2& from, double z) {
                   if (!std::isnan(z)) take(weight, from, z);
                 });
    };
    each([&](double weight, const glm::dvec2& from, double z) {
      n += weight;
      middle += weight * from;
      z1 += weight * z;
    });
    middle /= n;
    z1 /= n;
    each([&](double weight, const glm::dvec2& from, double z) {
      const glm::dvec2 d = from - middle;
      xx += weight * d.x * d.x;
      xy += weight * d.x * d.y;
      yy += weight * d.y * d.y;
      by += weight * (z - z1) * d;
    });
    constexpr double kNone = 1e-9;  // of the other direction, or of the weights
    if (const double det = xx * yy - xy * xy; det > kNone * xx * yy && det > 0.0)
      return glm::dvec2(yy * by.x - xy * by.y, xx * by.y - xy * by.x) / det;
    // On a line: along it.
    const glm::dvec2 along = xx >= yy ? glm::dvec2(xx, xy) : glm::dvec2(xy, yy);
    const double length = xx + yy;
    if (!(length > kNone * n)) return glm::dvec2(0.0);
    return along * (glm::dot(by, along) / (glm::dot(along, along) * length));
  }

  const OldSamples& old_;
  const Grid& field_;
  Resampling method_;
  glm::dvec2 stretch_;
  Taps x_, y_;
};

// Works out the samples of a rectangle within a tile.
void resampleTile(const FieldReader& field, const Places& places, Resampling method, const SampleRect& rect,
                  FieldBuilder& builder) {
  const double most = std::max(places.stretch.x, places.stretch.y);
  // A part of the tile whose old samples take a few megabytes.
  const auto side = static_cast<std::int32_t>(std::clamp(1024.0 / most, 1.0, double{kTileSide}));
  // The slope's kernel is a triangle that is a sample wider.
  const auto reach = [&](double stretch) {
    return std::max(reachOf(method, stretch), reachOf(Resampling::kLinear, stretch + 1.0)) + 1.0;
  };
  const double reach_x = reach(places.stretch.x), reach_y = reach(places.stretch.y);
  OldSamples old;
  Sampler sampler(old, field.grid(), method, places.stretch);
  std::vector<float> z;
  std::vector<std::uint8_t> marks;
  for (std::int32_t row = rect.row; row < rect.row + rect.rows; row += side)
    for (std::int32_t column = rect.column; column < rect.column + rect.columns; column += side) {
      const std::int32_t columns = std::min(side, rect.column + rect.columns - column);
      const std::int32_t rows = std::min(side, rect.row + rect.rows - row);
      glm::dvec2 low = places.at(column, row), high = low;
      for (const auto& [c, r] : {std::pair{columns - 1, 0}, {0, rows - 1}, {columns - 1, rows - 1}}) {
        low = glm::min(low, places.at(column + c, row + r));
        high = glm::max(high, places.at(column + c, row + r));
      }
      const auto left = static_cast<std::int32_t>(std::floor(low.x - reach_x));
      const auto bottom = static_cast<std::int32_t>(std::floor(low.y - reach_y));
      old.read(field, left, bottom, static_cast<std::int32_t>(std::ceil(high.x + reach_x)) - left + 1,
               static_cast<std::int32_t>(std::ceil(high.y + reach_y)) - bottom + 1);
      z.clear();
      marks.clear();
      for (std::int32_t r = 0; r < rows; ++r)
        for (std::int32_t c = 0; c < columns; ++c) {
          const glm::dvec2 p = places.at(column + c, row + r);
          z.push_back(sampler.heightAt(p));
          marks.push_back(sampler.markedAt(p) ? 1 : 0);
        }
      builder.writeHeights(column, row, columns, rows, z.data(), columns);
      builder.writeMarks(column, row, columns, rows, marks.data(), columns);
    }
}

// A multiple of 2^-20, as positions of points are.
glm::dvec2 onGrid(const glm::dvec2& p) {
  return {std::ldexp(std::round(std::ldexp(p.x, 20)), -20), std::ldexp(std::round(std::ldexp(p.y, 20)), -20)};
}

// The points of a line at their new places, with what is counted in samples in new ones.
EdgeLine resampledLine(const EdgeLine& line, const Places& places) {
  EdgeLine moved{line.id, line.closed, {}};
  const std::size_t n = line.points.size();
  const auto insertUpTo = [&](const EdgePoint& point) {
    const EdgePoint last = moved.points.back();
    const double apart = glm::distance(last.position, point.position);
    const int parts = static_cast<int>(std::ceil(apart / (0.999 * EdgeLine::kMostApart)));
    for (int k = 1; k < parts; ++k) {
      EdgePoint between = 2 * k < parts ? last : point;
      between.position =
          onGrid(last.position + (point.position - last.position) * (static_cast<double>(k) / parts));
      if (!last.located || !point.located) between = EdgePoint{between.position};
      moved.points.push_back(between);
    }
  };
  for (std::size_t i = 0; i < n; ++i) {
    EdgePoint point = line.points[i];
    // Across the line: along the normal n, a length changes by 1 / |B n|, where B turns new differences into old ones.
    const glm::dvec2 before = line.points[i == 0 ? (line.closed ? n - 1 : 0) : i - 1].position;
    const glm::dvec2 after = line.points[i + 1 == n ? (line.closed ? 0 : i) : i + 1].position;
    const glm::dvec2 along = after - before;
    if (const double length = glm::length(along); length > 0.0) {
      const glm::dvec2 normal = glm::dvec2(-along.y, along.x) / length;
      const double by =
          glm::length(glm::dvec2(glm::dot(places.per_column, normal), glm::dot(places.per_row, normal)));
      point.deviation /= by;
      point.slope_change *= by;
      point.slope_deviation *= by;
    }
    point.position = onGrid(places.newPlace(point.position));
    if (!moved.points.empty()) insertUpTo(point);
    moved.points.push_back(point);
  }
  if (line.closed && n > 1) insertUpTo(EdgePoint(moved.points.front()));
  return moved;
}

Result<Version> resampledSamples(const Version& field, const Places& places, const Grid& grid,
                                 Resampling method, JobControl& job) {
  Result<FieldBuilder> builder = FieldBuilder::create(grid, "the resampled field");
  if (!builder) return tl::unexpected(builder.error());
  const TileRange tiles = allTiles(grid);
  const FieldReader from = field.reader();
  job.begin("resampling", static_cast<std::uint64_t>(tiles.tiles()));
  tbb::parallel_for(std::int64_t{0}, tiles.tiles(), [&](std::int64_t i) {
    if (job.cancelled()) return;
    SampleRect rect{static_cast<std::int32_t>(i % tiles.columns) * kTileSide,
                    static_cast<std::int32_t>(i / tiles.columns) * kTileSide, 0, 0};
    rect.columns = std::min(kTileSide, grid.width - rect.column);
    rect.rows = std::min(kTileSide, grid.height - rect.row);
    resampleTile(from, places, method, rect, *builder);
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  const Version result = std::move(*builder).build();
  if (field.lines() == nullptr) return result;
  auto lines = std::make_shared<std::vector<EdgeLine>>();
  for (const EdgeLine& line : *field.lines()) lines->push_back(resampledLine(line, places));
  return result.withLines(std::move(lines));
}

}  // namespace

Grid resampledGrid(const Grid& grid, const ResampleOptions& options) {
  Grid made = grid;
  made.height_per_count = 0.0;
  (void)placesOf(grid, options, made);
  return made;
}

Result<Version> resampled(const Version& field, const ResampleOptions& options, JobControl& job) {
  Grid grid = field.grid();
  grid.height_per_count = 0.0;
  const Places places = placesOf(field.grid(), options, grid);
  if (std::max(places.stretch.x, places.stretch.y) > ResampleOptions::kMostCoarser)
    return inputError(
        fmt::format("the new spacing is more than {:g} times the old one", ResampleOptions::kMostCoarser),
        "the spacing", "do it in two steps");
  if (field.formOver() == nullptr) return resampledSamples(field, places, grid, options.method, job);
  const auto form = formAlong(field, places, grid.width, grid.height);
  // A form over samples is one of what is seen of them, too.
  const auto from = form && field.seenOf() == nullptr ? seenNear(field, field, job)
                    : form                            ? Result<Version>(field)
                                                      : withoutLayer(field, job);
  if (!from) return from;
  const auto heights = resampledSamples(*from, places, grid, options.method, job);
  if (!heights || !form) return heights;
  const auto raised = raisedUnder(*heights, *form, job);
  if (!raised) return raised;
  return seenUnder(*raised, form, job);
}

}  // namespace fettle::engine
