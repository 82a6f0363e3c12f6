#include "engine/measure/align_level.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

namespace fettle::engine {

namespace {

constexpr std::size_t kMostPoints = 300'000;

}  // namespace

std::int32_t AlignLevel::strideFor(std::size_t places) noexcept {
  return std::max(1, static_cast<std::int32_t>(std::ceil(
                         std::sqrt(static_cast<double>(places) / static_cast<double>(kMostPoints)))));
}

AlignLevel::AlignLevel(const HeightMap& first, const HeightMap& second, double sigma)
    : sigma_(sigma), spline_(smoothed(second, sigma, AtHoles::kFill, Borders::kLeftOut).value) {
  const SmoothMap smooth = smoothed(first, sigma, AtHoles::kStay, Borders::kLeftOut);
  std::size_t count = 0;
  for (const double z : smooth.value.z) count += std::isnan(z) ? 0 : 1;
  const std::int32_t stride = strideFor(count);
  points_.reserve(count);
  for (std::int32_t r = 0; r < first.height; r += stride)
    for (std::int32_t c = 0; c < first.width; c += stride) {
      const std::size_t i = first.index(c, r);
      if (std::isnan(smooth.value.z[i])) continue;
      points_.push_back({first.x0 + c * first.spacing_x, first.y0 + r * first.spacing_y, smooth.value.z[i],
                         smooth.slope_x[i], smooth.slope_y[i], c / stride, r / stride,
                         (r * kBlocks / first.height) * kBlocks + c * kBlocks / first.width});
    }
  least_spacing_ = std::min(first.spacing_x, first.spacing_y);
  step_x_ = stride * first.spacing_x;
  step_y_ = stride * first.spacing_y;
  columns_ = (first.width + stride - 1) / stride;
  rows_ = (first.height + stride - 1) / stride;
  for (std::int32_t c = 0; c < columns_; ++c) block_of_column_.push_back(c * stride * kBlocks / first.width);
  for (std::int32_t r = 0; r < rows_; ++r) block_of_row_.push_back(r * stride * kBlocks / first.height);
}

Matrix6 AlignLevel::correlatedSum(const std::vector<Vector6>& x, Pairs pairs) const {
  const auto reachOf = [this](double step) { return static_cast<std::int32_t>(5.0 * sigma_ / step); };
  const auto correlation = [this](double distance) {
    return std::exp(-0.25 * distance * distance / (sigma_ * sigma_));
  };
  const std::size_t places = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  std::vector<Vector6> all(places, Vector6::Zero()), along(places, Vector6::Zero());
  const auto at = [this](std::int32_t column, std::int32_t row) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  };
  const auto together = [pairs](const std::vector<std::int32_t>& block, std::int32_t a, std::int32_t b) {
    return pairs == Pairs::kAll || block[static_cast<std::size_t>(a)] == block[static_cast<std::size_t>(b)];
  };
  for (std::size_t i = 0; i < points_.size(); ++i) all[at(points_[i].column, points_[i].row)] = x[i];
  const std::int32_t across = reachOf(step_x_), up = reachOf(step_y_);
  tbb::parallel_for(std::int32_t{0}, rows_, [&](std::int32_t r) {
    for (std::int32_t c = 0; c < columns_; ++c)
      for (std::int32_t k = std::max(-across, -c); k <= std::min(across, columns_ - 1 - c); ++k)
        if (together(block_of_column_, c, c + k))
          along[at(c, r)] += correlation(k * step_x_) * all[at(c + k, r)];
  });
  std::vector<Matrix6> sums(static_cast<std::size_t>(rows_), Matrix6::Zero());
  tbb::parallel_for(std::int32_t{0}, rows_, [&](std::int32_t r) {
    for (std::int32_t c = 0; c < columns_; ++c) {
      Vector6 sum = Vector6::Zero();
      for (std::int32_t k = std::max(-up, -r); k <= std::min(up, rows_ - 1 - r); ++k)
        if (together(block_of_row_, r, r + k)) sum += correlation(k * step_y_) * along[at(c, r + k)];
      sums[static_cast<std::size_t>(r)] += all[at(c, r)] * sum.transpose();
    }
  });
  Matrix6 total = Matrix6::Zero();
  for (const Matrix6& sum : sums) total += sum;
  return 0.5 * (total + total.transpose());
}

std::vector<AlignLevel::Under> AlignLevel::under(const RigidMotion& motion) const {
  std::vector<Under> out(points_.size());
  const glm::dvec3 along = glm::transpose(motion.rotation)[2];
  tbb::parallel_for(std::size_t{0}, points_.size(), [&](std::size_t i) {
    const Point& point = points_[i];
    const glm::dvec3 foot = motion.movedBack({point.x, point.y, 0.0});
    // The height z at which the moved point lies on the second surface, by Newton.
    double z = point.z;
    MapSpline::Place place;
    for (int round = 0; round < 6; ++round) {
      const glm::dvec3 p = foot + z * along;
      place = spline_.at(p.x, p.y);
      if (!place.there) return;
      const double slope = along.z - place.slope_x * along.x - place.slope_y * along.y;
      if (!(slope > 0.05)) return;
      const double step = (place.z - p.z) / slope;
      z += step;
      if (std::abs(step) < 1e-12 * (1.0 + std::abs(z)) || (along.x == 0.0 && along.y == 0.0)) break;
    }
    const glm::dvec3 normal = motion.rotation * glm::dvec3(-place.slope_x, -place.slope_y, 1.0);
    if (!(normal.z > 0.05)) return;
    out[i] = {point.z - z, -normal.x / normal.z, -normal.y / normal.z, z};
  });
  return out;
}

}  // namespace fettle::engine
