#include "bench/rolled_work.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <limits>
#include <set>

#include "engine/base/job.h"
#include "engine/filter/ball_element.h"
#include "engine/filter/ball_erosion.h"
#include "engine/filter/erosion.h"
#include "engine/filter/patch.h"
#include "engine/simd/cpu.h"

namespace fettle::bench {

namespace {

using engine::BallElement;
using engine::Patch;
using engine::SampleRect;

// Of engine/filter/ball_erosion.cpp: blocks of results and groups of samples.
constexpr std::int32_t kBlock = 16, kWide = 8, kHigh = 4;
constexpr int kLargeShift = 4, kSmallShift = 2;
constexpr double kGroup = 16.0;  // small groups of a large one, samples of a small one
constexpr double kMostSums = 2e8;
constexpr double kNoHeight = std::numeric_limits<double>::infinity();

float signOf(const engine::Version& field, const engine::FilterSpec& spec) {
  return (spec.kind == engine::FilterKind::kOpening ? 1.0F : -1.0F) * field.reader().sign();
}

BallElement ballOf(const engine::Version& field, const engine::FilterSpec& spec) {
  const engine::HeightBounds bounds = field.reader().bounds();
  if (bounds.empty()) return {spec.nesting_mm, 0.0, 0.0, field.grid()};
  const auto low = static_cast<double>(bounds.min), high = static_cast<double>(bounds.max);
  return signOf(field, spec) < 0.0F ? BallElement{spec.nesting_mm, -high, -low, field.grid()}
                                    : BallElement{spec.nesting_mm, low, high, field.grid()};
}

struct TouchedPlace {
  std::int32_t column = 0, row = 0;
  friend auto operator<=>(const TouchedPlace&, const TouchedPlace&) = default;
};
using TouchedPlaces = std::set<TouchedPlace>;

TouchedPlace groupOf(const TouchedPlace& sample, const TouchedPlace& corner, int shift) {
  return {(sample.column - corner.column) >> shift, (sample.row - corner.row) >> shift};
}

// Adds the sample that the ball with its middle there touches: of several one that is there already, if it can be.
template <class T>
void addTouched(const BallElement& element, const Patch<T>& from, const TouchedPlace& middle,
                TouchedPlaces& touched) {
  const SampleRect& rect = from.rect;
  const std::int32_t c0 = std::max(middle.column - element.columns(), rect.column),
                     c1 = std::min(middle.column + element.columns() + 1, rect.column + rect.columns);
  const std::int32_t r0 = std::max(middle.row - element.rows(), rect.row),
                     r1 = std::min(middle.row + element.rows() + 1, rect.row + rect.rows);
  double least = kNoHeight;
  TouchedPlace found;
  bool known = false;
  for (std::int32_t r = r0; r < r1; ++r) {
    const T* const z = from.row(r);
    const double* const depths =
        element.table() != nullptr ? element.table() + (r - middle.row) * element.tableStride() : nullptr;
    for (std::int32_t c = c0; c < c1; ++c) {
      const std::int32_t away = c - middle.column;
      const double depth = depths != nullptr ? depths[away] : element.depthAt(away, r - middle.row);
      const double sum = static_cast<double>(z[c - rect.column]) + depth;
      if (!(sum <= least) || sum == kNoHeight) continue;
      const TouchedPlace place{c, r};
      if (sum == least && (known || !touched.contains(place))) continue;
      least = sum;
      found = place;
      known = touched.contains(place);
    }
  }
  touched.insert(found);
}

// Groups of 16 x 16 samples that a ball reaches from results of the block.
int groupsInReach(const BallElement& element, const SampleRect& from, const TouchedPlace& corner) {
  const auto first = [&](std::int32_t low, std::int32_t at, std::int32_t reach) {
    return (std::max(low, at - reach) - at) >> kLargeShift;
  };
  const auto last = [&](std::int32_t end, std::int32_t at, std::int32_t reach) {
    return (std::min(end, at + kBlock + reach) - 1 - at) >> kLargeShift;
  };
  const auto gap = [](std::int32_t group) { return std::max(std::abs(group) * kBlock - (kBlock - 1), 0); };
  const double relief = element.highest() - element.lowest();
  int groups = 0;
  for (std::int32_t j = first(from.row, corner.row, element.rows());
       j <= last(from.row + from.rows, corner.row, element.rows()); ++j)
    for (std::int32_t i = first(from.column, corner.column, element.columns());
         i <= last(from.column + from.columns, corner.column, element.columns()); ++i)
      groups += element.depthAt(gap(i), gap(j)) <= relief ? 1 : 0;
  return groups;
}

// What the results of a block need.
template <class T>
void countBlock(const BallElement& element, const Patch<T>& from, const SampleRect& block,
                BallTouches& counted) {
  const TouchedPlace corner{block.column, block.row};
  TouchedPlaces large;
  for (std::int32_t y = block.row; y < block.row + block.rows; y += kHigh)
    for (std::int32_t x = block.column; x < block.column + block.columns; x += kWide) {
      TouchedPlaces touched, small;
      int results = 0;
      for (std::int32_t r = y; r < std::min(y + kHigh, block.row + block.rows); ++r)
        for (std::int32_t c = x; c < std::min(x + kWide, block.column + block.columns); ++c) {
          if (!(static_cast<double>(from.row(r)[c - from.rect.column]) < kNoHeight)) continue;
          addTouched(element, from, {c, r}, touched);
          ++results;
        }
      for (const TouchedPlace& sample : touched) {
        small.insert(groupOf(sample, corner, kSmallShift));
        large.insert(groupOf(sample, corner, kLargeShift));
      }
      counted.sums += static_cast<double>(touched.size()) * results;
      counted.tests += kGroup * static_cast<double>(small.size());
    }
  if (large.empty()) return;  // no sample
  counted.tests += kGroup * static_cast<double>(large.size()) + groupsInReach(element, from.rect, corner);
}

SampleRect grown(const SampleRect& block, std::int32_t columns, std::int32_t rows, const engine::Grid& grid) {
  const std::int32_t c0 = std::max(block.column - columns, 0), r0 = std::max(block.row - rows, 0);
  return {c0, r0, std::min(block.column + block.columns + columns, grid.width) - c0,
          std::min(block.row + block.rows + rows, grid.height) - r0};
}

}  // namespace

std::int64_t chordsOfDisk(const engine::FilterSpec& spec, const engine::Grid& grid) {
  const engine::FlatElement disk(engine::Element::kDisk, spec.nesting_mm, grid);
  return 2 * (2 * std::int64_t{disk.rows} + 1);
}

BallPairs pairsOfBall(const engine::Version& field, const engine::FilterSpec& spec) {
  const BallElement element = ballOf(field, spec);
  BallPairs all;
  std::set<double> depths;
  for (std::int32_t r = 0; r <= element.rows(); ++r)
    for (std::int32_t c = 0; c <= element.columns(); ++c)
      if (const double depth = element.depthAt(c, r); depth < kNoHeight) {
        ++all.pairs;
        depths.insert(depth);
      }
  all.depths = static_cast<std::int64_t>(depths.size());
  return all;
}

std::array<BallTouches, 2> touchesOfBall(const engine::Version& field, const engine::FilterSpec& spec) {
  const engine::Grid& grid = field.grid();
  const engine::FieldReader reader = field.reader();
  const BallElement element = ballOf(field, spec);
  const float sign = signOf(field, spec);
  const double reached = (2.0 * element.columns() + 1.0) * (2.0 * element.rows() + 1.0);
  // Along each side.
  const auto blocks = static_cast<std::int32_t>(
      std::sqrt(std::clamp(kMostSums / (2.0 * kBlock * kBlock * reached), 4.0, 64.0)));
  const auto cornerOf = [&](std::int32_t block, std::int32_t samples) {
    return static_cast<std::int32_t>((2 * std::int64_t{block} + 1) * std::max(samples - kBlock, 0) /
                                     (2 * blocks));
  };
  std::array<BallTouches, 2> counted{};
  double samples = 0.0;
  engine::BallScratch scratch;
  Patch<float> heights;
  Patch<double> eroded;
  for (std::int32_t j = 0; j < blocks; ++j)
    for (std::int32_t i = 0; i < blocks; ++i) {
      const std::int32_t c = cornerOf(i, grid.width), r = cornerOf(j, grid.height);
      const SampleRect block{c, r, std::min(kBlock, grid.width - c), std::min(kBlock, grid.height - r)};
      heights.resize(grown(block, 2 * element.columns(), 2 * element.rows(), grid));
      reader.readHeights(heights.rect.column, heights.rect.row, heights.rect.columns, heights.rect.rows,
                         heights.values.data(), heights.stride);
      for (float& z : heights.values) z = z == z ? sign * z : std::numeric_limits<float>::infinity();
      countBlock(element, heights, block, counted[0]);
      eroded.resize(grown(block, element.columns(), element.rows(), grid));
      const engine::JobControl job;
      (void)engine::erode(element, heights, eroded, false, engine::bestCpuLevel(), scratch, job);
      for (double& z : eroded.values) z = -z;
      countBlock(element, eroded, block, counted[1]);
      samples += static_cast<double>(block.columns) * block.rows;
    }
  for (BallTouches& each : counted) {
    each.sums /= samples;
    each.tests /= samples;
  }
  return counted;
}

}  // namespace fettle::bench
