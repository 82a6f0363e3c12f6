#include "engine/measure/fit_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>

namespace fettle::engine {

namespace {

double middleOfHeights(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return double{*middle};
}

}  // namespace

FitSamples::FitSamples(const Version& field, const FitRegion& region, std::int32_t stride) : stride_(stride) {
  const Grid& grid = field.grid();
  const FieldReader reader = field.reader();
  spacing_x_ = grid.spacingXMm();
  spacing_y_ = grid.spacingYMm();
  unit_ = grid.height_unit.mm;
  double columns = 0.0, rows = 0.0;
  std::int32_t left = grid.width, right = 0, low = grid.height, high = 0;
  std::vector<float> row;
  for (const SampleRun& run : region.runs) {
    if (run.row % stride != 0) continue;
    const std::int32_t begin = (run.column + stride - 1) / stride * stride;
    const std::int32_t count = (run.column + run.columns - begin + stride - 1) / stride;
    if (count <= 0) continue;
    row.resize(static_cast<std::size_t>(run.columns));
    reader.readHeights(run.column, run.row, run.columns, 1, row.data(), run.columns);
    for (std::int32_t from = 0; from < count; from += kBlock) {
      const std::int32_t some = std::min(kBlock, count - from);
      // Short runs of one row share a block only with themselves: a block is one stretch.
      blocks_.push_back({heights_.size(), run.row, begin + from * stride, some});
      for (std::int32_t i = from; i < from + some; ++i)
        heights_.push_back(row[static_cast<std::size_t>(begin - run.column + i * stride)]);
    }
    const std::int32_t last = begin + (count - 1) * stride;
    columns += 0.5 * count * (1.0 * begin + last);
    rows += 1.0 * run.row * count;
    left = std::min(left, begin);
    right = std::max(right, last);
    low = std::min(low, run.row);
    high = std::max(high, run.row);
  }
  size_ = heights_.size();
  if (size_ == 0) return;
  std::vector<float> sorted = heights_;
  const double middle = middleOfHeights(sorted);
  const auto n = static_cast<double>(size_);
  middle_ = {columns / n * spacing_x_, rows / n * spacing_y_, middle * unit_};
  lattice_ = {low / stride, left / stride, (high - low) / stride + 1, (right - left) / stride + 1};
  low_ = glm::dvec2(left * spacing_x_ - middle_.x, low * spacing_y_ - middle_.y);
  high_ = glm::dvec2(right * spacing_x_ - middle_.x, high * spacing_y_ - middle_.y);
  // Of nine in ten heights: a spike is no part of the region's extent.
  const auto place = [&](double share) {
    const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(share * (n - 1.0));
    std::ranges::nth_element(sorted, at);
    return double{*at};
  };
  const double bottom = place(0.05), top = place(0.95);
  reach_ = 0.5 * glm::length(glm::dvec3((right - left) * spacing_x_, (high - low) * spacing_y_,
                                        (top - bottom) * unit_));
  const double most = std::max({std::abs(bottom), std::abs(top), std::abs(middle)});
  // Half a unit in the last place to both sides, evenly.
  rounding_ = most * unit_ * std::numeric_limits<float>::epsilon() / std::sqrt(12.0);
}

FitSamples::FitSamples(std::vector<glm::dvec3> points, const glm::dvec3& middle)
    : points_(std::move(points)), size_(points_.size()), middle_(middle) {
  for (std::size_t first = 0; first < size_; first += kBlock)
    blocks_.push_back({first, 0, 0, static_cast<std::int32_t>(std::min<std::size_t>(kBlock, size_ - first))});
  for (const glm::dvec3& p : points_) reach_ = std::max(reach_, glm::length(p));
}

void FitSamples::read(std::size_t block, Block& out) const noexcept {
  const Place& place = blocks_[block];
  out.count = place.count;
  out.row = place.row / stride_;
  out.column = place.column / stride_;
  for (std::int32_t i = 0; i < place.count; ++i) {
    const std::size_t at = place.first + static_cast<std::size_t>(i);
    out.points[static_cast<std::size_t>(i)] =
        points_.empty()
            ? glm::dvec3((place.column + i * stride_) * spacing_x_ - middle_.x,
                         place.row * spacing_y_ - middle_.y, double{heights_[at]} * unit_ - middle_.z)
            : points_[at];
  }
}

glm::dvec2 FitSamples::along(std::size_t block) const noexcept {
  const Place& place = blocks_[block];
  if (!points_.empty()) return points_[place.first];
  return {place.column * spacing_x_ - middle_.x, place.row * spacing_y_ - middle_.y};
}

double FitSamples::xOf(std::int32_t column) const noexcept {
  return (lattice_.column + column) * stride_ * spacing_x_ - middle_.x;
}

FitSamples::Coarse FitSamples::coarse(std::size_t most) const {
  Coarse coarse;
  if (blocks_.empty()) return coarse;
  std::int32_t left = std::numeric_limits<std::int32_t>::max(), right = 0, low = left, high = 0;
  for (const Place& place : blocks_) {
    left = std::min(left, place.column);
    right = std::max(right, place.column + (place.count - 1) * stride_);
    low = std::min(low, place.row);
    high = std::max(high, place.row);
  }
  // Blocks of about the same sides in millimetres, of at least one sample.
  const double wide = (right - left + stride_) * spacing_x_, tall = (high - low + stride_) * spacing_y_;
  const double side = std::sqrt(wide * tall / static_cast<double>(most));
  const auto block = [this](double wished, double spacing) {
    return stride_ * std::max(1, static_cast<std::int32_t>(std::ceil(wished / (spacing * stride_) - 1e-9)));
  };
  std::int32_t across = block(side, spacing_x_), up = block(side, spacing_y_);
  const auto counted = [&] {
    coarse.columns = (right - left) / across + 1;
    coarse.rows = (high - low) / up + 1;
    return static_cast<std::size_t>(coarse.columns) * static_cast<std::size_t>(coarse.rows);
  };
  while (counted() > most) (coarse.columns >= coarse.rows ? across : up) += stride_;

  struct Pile {
    std::vector<float> heights;
    double x = 0.0, y = 0.0;
  };
  std::vector<Pile> piles;
  // Blocks of samples come by row: a row of piles is finished when the next one begins.
  std::int32_t current = -1;
  const auto finish = [&] {
    for (std::size_t c = 0; c < piles.size(); ++c) {
      Pile& pile = piles[c];
      if (pile.heights.empty()) continue;
      const auto n = static_cast<double>(pile.heights.size());
      coarse.points.emplace_back(pile.x / n, pile.y / n, middleOfHeights(pile.heights) * unit_ - middle_.z);
      coarse.column.push_back(static_cast<std::int32_t>(c));
      coarse.row.push_back(current);
    }
    piles.assign(static_cast<std::size_t>(coarse.columns), {});
  };
  for (const Place& place : blocks_) {
    const std::int32_t row = (place.row - low) / up;
    if (row != current) {
      finish();
      current = row;
    }
    for (std::int32_t i = 0; i < place.count; ++i) {
      const std::int32_t column = place.column + i * stride_;
      Pile& pile = piles[static_cast<std::size_t>((column - left) / across)];
      pile.heights.push_back(heights_[place.first + static_cast<std::size_t>(i)]);
      pile.x += column * spacing_x_ - middle_.x;
      pile.y += place.row * spacing_y_ - middle_.y;
    }
  }
  finish();
  return coarse;
}

}  // namespace fettle::engine
