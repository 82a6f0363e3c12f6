#include "engine/measure/three_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "engine/measure/around.h"

namespace fettle::engine {

namespace {

ThreePointPlane::Mean meanAround(const FieldReader& reader, const glm::dvec2& at, double radius_mm,
                                 Region region) {
  ThreePointPlane::Mean mean;
  double first = 0.0, sum = 0.0;  // from the first one, so that heights far from 0 cost no digits
  glm::dvec2 places(0.0);
  forEachAround(reader, at, radius_mm, region, [&](std::int32_t c, std::int32_t r, double z) {
    if (mean.samples == 0) first = z;
    sum += z - first;
    places += glm::dvec2(c, r);
    ++mean.samples;
  });
  const auto n = static_cast<double>(std::max<std::int64_t>(1, mean.samples));
  mean.height = first + sum / n;
  mean.at_mm = places / n * glm::dvec2(reader.grid().spacingXMm(), reader.grid().spacingYMm());
  return mean;
}

// How far the nearest of three points is from the line through the other two, and the longest distance of two.
struct PointTriangle {
  double height_mm = 0.0, longest_mm = 0.0;
};
PointTriangle pointTriangleOf(const std::array<ThreePointPlane::Mean, 3>& means) noexcept {
  const glm::dvec2 a = means[1].at_mm - means[0].at_mm, b = means[2].at_mm - means[0].at_mm;
  const double longest = std::max({glm::length(a), glm::length(b), glm::length(b - a)});
  return {longest > 0.0 ? std::abs(a.x * b.y - a.y * b.x) / longest : 0.0, longest};
}

}  // namespace

ThreePoints ThreePoints::onMeans(const Grid& grid, int step) const noexcept {
  ThreePoints moved = *this;
  const glm::dvec2 spacing(grid.spacingXMm(), grid.spacingYMm());
  // The first mean lies in the middle of the first samples.
  for (glm::dvec2& at : moved.at_mm) at -= 0.5 * (step - 1) * spacing;
  if (moved.radius_mm == 0.0) moved.radius_mm = usualProbeRadiusMm(grid);
  return moved;
}

Result<ThreePointPlane> planeThrough(const Version& field, const ThreePoints& points, Region region) {
  constexpr double kLeastOfLongest = 0.02;
  const FieldReader reader = field.reader();
  const Grid& grid = field.grid();
  const double radius = points.radius_mm == 0.0 ? usualProbeRadiusMm(grid) : points.radius_mm;
  ThreePointPlane plane;
  for (std::size_t k = 0; k < points.at_mm.size(); ++k) {
    const glm::dvec2& at = points.at_mm[k];
    if (!canProbe(grid, at, radius))
      return inputError("there is no such place or radius", "through",
                        "give fewer than a thousand samples as radius");
    plane.means[k] = meanAround(reader, at, radius, region);
    if (plane.means[k].samples == 0)
      return inputError(fmt::format("no sample counts within {:.6g} mm of {:.6g},{:.6g}", radius, at.x, at.y),
                        "through",
                        region == Region::kAll ? "choose a place with samples, or a larger radius"
                                               : "choose a place with such samples, or count all samples");
    plane.samples += plane.means[k].samples;
  }
  const auto [off_mm, longest_mm] = pointTriangleOf(plane.means);
  if (off_mm < std::max(std::min(grid.spacingXMm(), grid.spacingYMm()), kLeastOfLongest * longest_mm))
    return inputError(
        fmt::format("the three points lie nearly on a line: one is {:.3g} mm off the others'", off_mm),
        "through", "choose three that lie far apart in both directions");

  const auto& [p, q, r] = plane.means;
  const glm::dvec2 a = q.at_mm - p.at_mm, b = r.at_mm - p.at_mm;
  const double area = a.x * b.y - a.y * b.x;
  // Slopes in the unit of heights by mm: sums of the three heights with these weights.
  const std::array by_x{(a.y - b.y) / area, b.y / area, -a.y / area};
  const std::array by_y{(b.x - a.x) / area, -b.x / area, a.x / area};
  const double up = q.height - p.height, on = r.height - p.height;
  const double slope_x = by_x[1] * up + by_x[2] * on, slope_y = by_y[1] * up + by_y[2] * on;
  const double half_width = 0.5 * (grid.width - 1), half_height = 0.5 * (grid.height - 1);
  const double by_column = slope_x * grid.spacingXMm(), by_row = slope_y * grid.spacingYMm();
  plane.form = {1,
                grid.width,
                grid.height,
                p.height,
                {slope_x * (half_width * grid.spacingXMm() - p.at_mm.x) +
                     slope_y * (half_height * grid.spacingYMm() - p.at_mm.y),
                 by_row * half_height, by_column * half_width}};

  double square = 0.0;
  for (const glm::dvec2& at : points.at_mm)
    forEachAround(reader, at, radius, region, [&](std::int32_t c, std::int32_t row, double z) {
      const double off = z - plane.form.heightAt(c, row);
      square += off * off;
    });
  const auto n = static_cast<double>(plane.samples);
  plane.rms = std::sqrt(square / n);
  // The plane takes up three of the samples' freedoms.
  const double variance = plane.samples > 3 ? square / (n - 3.0) : std::numeric_limits<double>::quiet_NaN();
  const auto errorOf = [&](const std::array<double, 3>& weights) {
    double sum = 0.0;
    for (std::size_t k = 0; k < weights.size(); ++k)
      sum += weights[k] * weights[k] * variance / static_cast<double>(plane.means[k].samples);
    return std::sqrt(sum) * grid.height_unit.mm;
  };
  plane.slope_x_error = errorOf(by_x);
  plane.slope_y_error = errorOf(by_y);
  return plane;
}

}  // namespace fettle::engine
