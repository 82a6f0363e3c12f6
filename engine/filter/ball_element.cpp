#include "engine/filter/ball_element.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fettle::engine {

namespace {

// A radius of three spacings reaches three samples, though 3 * 0.1 / 0.1 is less.
constexpr double kRoundUpBall = 1.0 + 1e-9;
constexpr std::int64_t kLargestTable = std::int64_t{1} << 21;  // depths
constexpr std::int32_t kLargestPatches = 128;                  // samples of reach
constexpr double kBend = 0.9;                                  // of the radius' square: slopes of 3
// Squares of larger radii and distances are no floats: such a ball is taken for a plane that lies at its top.
constexpr double kFlatRadius = 1e15;
// More than what rounding of a few operations with floats can do.
constexpr double kFromBelow = 1.0 - 0x1p-20;

}  // namespace

BallElement::BallElement(double radius_mm, double lowest, double highest, const Grid& grid)
    : radius_(radius_mm),
      lowest_(lowest),
      highest_(highest),
      depth_{.radius = radius_mm,
             .squared = radius_mm * radius_mm,
             .most = radius_mm * radius_mm * kRoundUpBall,
             .spacing_x = grid.spacingXMm(),
             .spacing_y = grid.spacingYMm(),
             .height_mm = grid.height_unit.mm} {
  const double wide = Grid::kMaxSide * depth_.spacing_x, high = Grid::kMaxSide * depth_.spacing_y;
  const double far = std::min(depth_.squared, wide * wide + high * high);
  deepest_ = far / (radius_ + std::sqrt(depth_.squared - far)) / depth_.height_mm;
  // The last one that is no deeper than the relief.
  const double relief = highest - lowest;
  const auto reach = [&](std::int32_t samples, const auto& depth) {
    std::int32_t low = 0, high_end = samples;
    while (low + 1 < high_end) {
      const std::int32_t middle = low + (high_end - low) / 2;
      (depth(middle) <= relief ? low : high_end) = middle;
    }
    return low;
  };
  columns_ = reach(grid.width, [&](std::int32_t d) { return depthAt(d, 0); });
  rows_ = reach(grid.height, [&](std::int32_t d) { return depthAt(0, d); });

  const double x2 = depth_.spacing_x * depth_.spacing_x, y2 = depth_.spacing_y * depth_.spacing_y;
  const bool flat = radius_ > kFlatRadius;
  const double radius = flat ? kFlatRadius : radius_, unit = flat ? 0.0 : 1.0 / depth_.height_mm;
  shape_ = {.square_x = static_cast<float>(x2),
            .square_y = static_cast<float>(y2),
            .bend = static_cast<float>(kBend * radius * radius),
            .squared = static_cast<float>(radius * radius),
            .radius = static_cast<float>(radius),
            .slope_beyond = static_cast<float>(0.5 / (radius * std::sqrt(1.0 - kBend)) * unit),
            .per_unit = static_cast<float>(unit),
            .steep_x = static_cast<float>(depth_.height_mm * depth_.height_mm / x2),
            .steep_y = static_cast<float>(depth_.height_mm * depth_.height_mm / y2)};
  curved_x_ = x2 / radius * unit * kFromBelow;
  curved_y_ = y2 / radius * unit * kFromBelow;

  const std::int64_t stride = 2 * (std::int64_t{columns_} + kMargin) + 1;
  const std::int64_t up = std::int64_t{rows_} + kMargin;
  if (stride * (2 * up + 1) > kLargestTable) return;
  table_stride_ = stride;
  table_.reserve(static_cast<std::size_t>(stride * (2 * up + 1)));
  for (std::int64_t r = -up; r <= up; ++r)
    for (std::int64_t c = -columns_ - kMargin; c <= columns_ + kMargin; ++c)
      table_.push_back(std::abs(r) > rows_ ? std::numeric_limits<double>::infinity() : depthAt(c, r));
  if (std::max(columns_, rows_) <= kLargestPatches) makePatches();
}

void BallElement::makePatches() {
  patch_columns_ = (columns_ + kMargin) / 4;
  patch_rows_ = (rows_ + kMargin) / 4;
  patch_stride_ = std::ptrdiff_t{2 * patch_columns_ + 1} * kPatch;
  patches_.resize(static_cast<std::size_t>((2 * patch_rows_ + 1) * patch_stride_));
  const double x2 = depth_.spacing_x * depth_.spacing_x, y2 = depth_.spacing_y * depth_.spacing_y;
  const double bend = shape_.bend, squared = shape_.squared, radius = shape_.radius, unit = shape_.per_unit;
  float* patch = patches_.data();
  for (std::int32_t j = -patch_rows_; j <= patch_rows_; ++j)
    for (std::int32_t i = -patch_columns_; i <= patch_columns_; ++i, patch += kPatch)
      for (int l = 0; l < 16; ++l) {
        const int column = 4 * i + l % 4, row = 4 * j + l / 4;
        const double x = column - 3.5, y = row - 1.5, s = x * x * x2 + y * y * y2;
        const double within = std::min(s, bend), root = std::sqrt(squared - within);
        const double depth = within / (radius + root) * unit + (s - within) * shape_.slope_beyond;
        patch[l] = static_cast<float>(depth * kFromBelow);
        patch[16 + l] = static_cast<float>(-x * x2 / root * unit);
        patch[32 + l] = static_cast<float>(-y * y2 / root * unit);
      }
}

float BallElement::steepest(std::int32_t side) const noexcept {
  // A little farther, as rounding could hide that a corner lies outside.
  const double half = 0.51 * (side - 1) * std::hypot(depth_.spacing_x, depth_.spacing_y);
  if (!(half < radius_)) return 0.0F;
  const double squared = std::min((radius_ - half) * (radius_ - half), kBend * depth_.squared);
  return static_cast<float>(squared / (depth_.squared - squared));
}

}  // namespace fettle::engine
