#include "engine/measure/three_point_errors.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>

#include "engine/measure/around.h"

namespace fettle::engine {

namespace {

constexpr std::size_t kPoints = 3;

// How many samples of a line are around each of the points.
using LineCounts = std::map<std::int32_t, std::array<double, kPoints>>;

// Variance that offsets of variance 1 give to the sum of the three means with these weights.
double varianceOf(const LineCounts& lines, const ThreePointPlane& plane,
                  const std::array<double, kPoints>& weights) {
  double variance = 0.0;
  for (const auto& [line, counts] : lines) {
    double sum = 0.0;
    for (std::size_t k = 0; k < kPoints; ++k)
      sum += weights[k] * counts[k] / static_cast<double>(plane.means[k].samples);
    variance += sum * sum;
  }
  return variance;
}

// Sum of squares about their mean that such offsets give to the samples around each point.
double scatterOf(const LineCounts& lines, const ThreePointPlane& plane) {
  double sum = 0.0;
  for (std::size_t k = 0; k < kPoints; ++k) {
    double squares = 0.0;
    for (const auto& [line, counts] : lines) squares += counts[k] * counts[k];
    sum +=
        static_cast<double>(plane.means[k].samples) - squares / static_cast<double>(plane.means[k].samples);
  }
  return sum;
}

}  // namespace

void addLineErrors(ThreePointPlane& plane, const Version& field, const ThreePoints& points, Region region,
                   const SectionNoise& noise) {
  if (!(noise.rows_mm > 0.0 || noise.columns_mm > 0.0)) return;
  const Grid& grid = field.grid();
  const FieldReader reader = field.reader();
  const double radius = points.radius_mm == 0.0 ? usualProbeRadiusMm(grid) : points.radius_mm;
  LineCounts rows, columns;
  for (std::size_t k = 0; k < kPoints; ++k)
    forEachAround(reader, points.at_mm[k], radius, region, [&](std::int32_t c, std::int32_t r, double) {
      rows[r][k] += 1.0;
      columns[c][k] += 1.0;
    });
  // As planeThrough(): slopes [mm/mm] as sums of the three heights [mm].
  const auto& [p, q, r] = plane.means;
  const glm::dvec2 a = q.at_mm - p.at_mm, b = r.at_mm - p.at_mm;
  const double area = a.x * b.y - a.y * b.x;
  const std::array by_x{(a.y - b.y) / area, b.y / area, -a.y / area};
  const std::array by_y{(b.x - a.x) / area, -b.x / area, a.x / area};
  const double of_rows = noise.rows_mm * noise.rows_mm, of_columns = noise.columns_mm * noise.columns_mm;
  const double freedom = static_cast<double>(plane.samples) - 3.0;
  // The samples' own noise: what is left of their scatter. With one sample each nothing shows it.
  double own = noise.sample_mm * noise.sample_mm;
  if (freedom > 0.0) {
    const double scatter = std::pow(plane.rms * grid.height_unit.mm, 2) * static_cast<double>(plane.samples);
    const double rest =
        (scatter - of_rows * scatterOf(rows, plane) - of_columns * scatterOf(columns, plane)) / freedom;
    own = std::isnan(own) ? std::fmax(rest, 0.0) : std::fmax(rest, own);
  }
  const auto errorOf = [&](const std::array<double, kPoints>& weights) {
    double sum =
        of_rows * varianceOf(rows, plane, weights) + of_columns * varianceOf(columns, plane, weights);
    for (std::size_t k = 0; k < kPoints; ++k)
      sum += weights[k] * weights[k] * own / static_cast<double>(plane.means[k].samples);
    return std::sqrt(sum);
  };
  plane.slope_x_error = errorOf(by_x);
  plane.slope_y_error = errorOf(by_y);
}

}  // namespace fettle::engine
