#include "engine/measure/probe.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Dense>

#include "engine/measure/around.h"

namespace fettle::engine {

namespace {

constexpr int kQuadratic = 6;

struct ProbedSample {
  double x = 0.0, y = 0.0, z = 0.0;  // from the point, in radii; height [mm]
  std::int32_t column = 0, row = 0;
};

// What rows or columns that are off by noise of variance 1 do to the numbers of the quadratic, and to what it leaves.
struct ProbedLines {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(kQuadratic, kQuadratic);
  double left = 0.0, scatter = 0.0;  // of the sum of squares: expected, and variance of it
};

ProbedLines linesIn(const std::vector<ProbedSample>& samples, std::int32_t ProbedSample::*line,
                    const Eigen::MatrixXd& rows, const Eigen::MatrixXd& unit) {
  std::map<std::int32_t, std::pair<Eigen::VectorXd, double>> sums;  // of derivatives, and how many
  for (std::size_t i = 0; i < samples.size(); ++i) {
    auto& [sum, count] =
        sums.try_emplace(samples[i].*line, Eigen::VectorXd::Zero(kQuadratic), 0.0).first->second;
    sum += rows.row(static_cast<Eigen::Index>(i)).transpose();
    count += 1.0;
  }
  ProbedLines of;
  for (const auto& [at, line_sum] : sums) {
    const Eigen::VectorXd numbers = unit * line_sum.first;
    of.covariance += numbers * numbers.transpose();
    of.left += line_sum.second - line_sum.first.dot(numbers);
  }
  of.scatter = 2.0 * of.left * of.left / std::max(1.0, static_cast<double>(sums.size()) - kQuadratic);
  return of;
}

}  // namespace

Result<ProbeFigures> probeAt(const Version& field, glm::dvec2 at, double radius_mm, Region region,
                             const SectionNoise& noise) {
  const FieldReader reader = field.reader();
  const Grid& grid = field.grid();
  const glm::dvec2 spacing(grid.spacingXMm(), grid.spacingYMm());
  if (!canProbe(grid, at, radius_mm))
    return inputError("there is no such place or radius", "probe",
                      "give fewer than a thousand samples as radius");
  std::vector<ProbedSample> samples;
  forEachAround(reader, at, radius_mm, region, [&](std::int32_t c, std::int32_t r, double z) {
    const glm::dvec2 from = (glm::dvec2(c, r) * spacing - at) / radius_mm;
    samples.push_back({from.x, from.y, z * grid.height_unit.mm, c, r});
  });
  const auto n = static_cast<Eigen::Index>(samples.size());
  Eigen::MatrixXd rows(n, kQuadratic);
  Eigen::VectorXd heights(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ProbedSample& s = samples[static_cast<std::size_t>(i)];
    rows.row(i) << 1.0, s.x, s.y, s.x * s.x, s.x * s.y, s.y * s.y;
    heights[i] = s.z;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(1e-8);
  if (n >= kQuadratic) qr.compute(rows);
  const glm::dvec2 size((grid.width - 1) * spacing.x, (grid.height - 1) * spacing.y);
  if (n == 0 && (at.x < 0.0 || at.y < 0.0 || at.x > size.x || at.y > size.y))
    return inputError(fmt::format("{:.6g},{:.6g} lies outside of the scan", at.x, at.y), "probe",
                      fmt::format("the scan is from 0,0 to {:.6g},{:.6g} mm", size.x, size.y));
  if (n < kQuadratic || qr.rank() < kQuadratic)
    return inputError(fmt::format("{} samples within {:.6g} mm of {:.6g},{:.6g} show no curved surface", n,
                                  radius_mm, at.x, at.y),
                      "probe", "give a larger radius, or a place that is not at a border or a hole");
  // From their mean, so that heights far from 0 cost no digits.
  const double base = heights.mean();
  const Eigen::VectorXd x = qr.solve((heights.array() - base).matrix());
  const Eigen::VectorXd residual = (heights.array() - base).matrix() - rows * x;
  const Eigen::MatrixXd unit =
      (rows.transpose() * rows).ldlt().solve(Eigen::MatrixXd::Identity(kQuadratic, kQuadratic));
  Eigen::MatrixXd by_lines = Eigen::MatrixXd::Zero(kQuadratic, kQuadratic);
  double lines_left = 0.0, lines_scatter = 0.0;
  const auto addLines = [&](double mm, std::int32_t ProbedSample::*line) {
    if (!(mm > 0.0)) return;
    const ProbedLines lines = linesIn(samples, line, rows, unit);
    by_lines += mm * mm * lines.covariance;
    lines_left += mm * mm * lines.left;
    lines_scatter += std::pow(mm, 4) * lines.scatter;
  };
  addLines(noise.rows_mm, &ProbedSample::row);
  addLines(noise.columns_mm, &ProbedSample::column);
  double variance = noise.sample_mm * noise.sample_mm;
  if (n > kQuadratic) {
    const auto freedom = static_cast<double>(n - kQuadratic);
    const double squares = residual.squaredNorm(), of_samples = variance * freedom;
    const double scatter = std::sqrt(2.0 * of_samples * of_samples / freedom + lines_scatter);
    if (std::isnan(variance) || squares > of_samples + lines_left + 3.0 * scatter)
      variance = std::max(0.0, squares - lines_left) / freedom;
  }
  const Eigen::MatrixXd covariance = variance * unit + by_lines;
  const double by = 1.0 / radius_mm, p = x[1] * by, q = x[2] * by;
  const double xx = 2.0 * x[3] * by * by, xy = x[4] * by * by, yy = 2.0 * x[5] * by * by;
  const double square = p * p + q * q, w = std::sqrt(1.0 + square), slope = std::sqrt(square);
  constexpr double kDegree = 180.0 / std::numbers::pi;
  ProbeFigures figures;
  figures.samples = static_cast<int>(n);
  figures.rms_mm = std::sqrt(residual.squaredNorm() / static_cast<double>(n));
  figures.height_mm = {base + x[0], std::sqrt(covariance(0, 0))};
  // Where the surface is level the direction of the steepest slope is not known: both directions' mean error.
  const double slope_variance =
      square > 0.0
          ? (p * p * covariance(1, 1) + 2.0 * p * q * covariance(1, 2) + q * q * covariance(2, 2)) / square
          : 0.5 * (covariance(1, 1) + covariance(2, 2));
  figures.slope_deg = {std::atan(slope) * kDegree, std::sqrt(slope_variance) * by / (w * w) * kDegree};
  figures.rises_to_deg = square > 0.0 ? std::atan2(q, p) * kDegree : std::numeric_limits<double>::quiet_NaN();
  const double mean = ((1.0 + q * q) * xx - 2.0 * p * q * xy + (1.0 + p * p) * yy) / (2.0 * w * w * w);
  const double gauss = (xx * yy - xy * xy) / (w * w * w * w);
  const double apart = std::sqrt(std::max(0.0, mean * mean - gauss));
  figures.most_curvature = mean + apart;
  figures.least_curvature = mean - apart;
  // By the second derivatives; those of the slope are smaller by the curvature times the radius.
  Eigen::VectorXd row = Eigen::VectorXd::Zero(kQuadratic);
  const double factor = by * by / (2.0 * w * w * w);
  row[3] = 2.0 * (1.0 + q * q) * factor;
  row[4] = -2.0 * p * q * factor;
  row[5] = 2.0 * (1.0 + p * p) * factor;
  figures.mean_curvature = {mean, std::sqrt(row.dot(covariance * row))};
  return figures;
}

}  // namespace fettle::engine
