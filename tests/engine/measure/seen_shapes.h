#pragma once

// Shapes as a scanner sees them, for the tests of fits.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <glm/geometric.hpp>

#include "engine/field/builder.h"
#include "engine/measure/fit.h"
#include "engine/measure/fit_choice.h"

namespace fettle::engine {

inline constexpr double kFitHole = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kFitDegree = std::numbers::pi / 180.0;

// Heights of a shape over (x, y), by bisection along z between two bounds: a plain twin of what is fitted.
inline double heightOn(const Shape& shape, double x, double y, double low, double high) {
  const auto at = [&](double z) { return distanceFrom(shape, {x, y, z}); };
  if (!(at(low) <= 0.0 && at(high) >= 0.0)) return kFitHole;
  for (int k = 0; k < 80; ++k) {
    const double middle = 0.5 * (low + high);
    (at(middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

struct FitField {
  int width = 60, height = 50;
  double spacing_x = 0.1, spacing_y = 0.1;
};

inline Version fieldWith(const FitField& of, const std::function<double(double, double)>& z,
                         double noise = 0.0, std::uint64_t seed = 1) {
  Grid grid;
  grid.width = of.width;
  grid.height = of.height;
  grid.spacing_x = of.spacing_x;
  grid.spacing_y = of.spacing_y;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<float> heights;
  for (int r = 0; r < of.height; ++r)
    for (int c = 0; c < of.width; ++c)
      heights.push_back(static_cast<float>(z(c * of.spacing_x, r * of.spacing_y) + noise * normal(random)));
  return makeField(grid, heights);
}

inline FitRegion wholeOf(const Version& field) {
  JobControl job;
  auto region = wholeRegion(field, Region::kAll, job);
  return region ? *std::move(region) : FitRegion{};
}

inline Result<ShapeFit> fitOf(const Version& field, ShapeKind kind, const FitOptions& options = {}) {
  JobControl job;
  return fitShape(FitSamples(field, wholeOf(field)), kind, options, job);
}

// A part of each shape as seen from above, 6 x 5 mm around (3, 2.5); the bounds of z for heightOn.
struct SeenShape {
  std::string name;
  Shape shape;
  double low = -50.0, high = 50.0;
};
inline std::vector<SeenShape> seenShapes() {
  const auto axis = [](double x, double y, double z) { return glm::normalize(glm::dvec3(x, y, z)); };
  return {
      {"plane", {ShapeKind::kPlane, {3.0, 2.5, 0.2}, axis(0.2, -0.1, 1.0)}, -9, 9},
      {"ball", {ShapeKind::kSphere, {2.7, 2.9, -3.0}, {0, 0, 1}, 6.0}, -3, 9},
      {"hollow ball", {ShapeKind::kSphere, {2.7, 2.9, 7.0}, {0, 0, 1}, 6.0, 0, 0, true}, -9, 7},
      {"cylinder", {ShapeKind::kCylinder, {3.0, 2.5, -4.0}, axis(1.0, 0.4, 0.1), 6.0}, -3, 9},
      {"hollow cylinder",
       {ShapeKind::kCylinder, {3.0, 2.5, 8.0}, axis(0.1, 1.0, -0.2), 6.0, 0, 0, true},
       -9,
       7},
      {"cone", {ShapeKind::kCone, {-9.0, 2.0, -2.0}, axis(1.0, 0.1, -0.1), 0, 0, 20.0 * kFitDegree}, -2.2, 9},
      {"countersink",
       {ShapeKind::kCone, {3.1, 2.4, -2.0}, axis(0.02, 0.01, 1.0), 0, 0, 45.0 * kFitDegree, true},
       -9,
       9},
      {"ring", {ShapeKind::kTorus, {3.0, 2.5, 0.0}, axis(0.03, 0.02, 1.0), 4.0, 3.0}, 0.05, 4},
      {"hollow ring",
       {ShapeKind::kTorus, {3.0, -4.0, 5.0}, axis(1.0, 0.1, 0.05), 8.0, 3.5, 0, true},
       -9,
       -2.0},
  };
}

inline Version seenField(const SeenShape& seen, double noise = 0.0, std::uint64_t seed = 1,
                         const FitField& of = {}) {
  return fieldWith(
      of, [&](double x, double y) { return heightOn(seen.shape, x, y, seen.low, seen.high); }, noise, seed);
}

// What a whole row or column is off, besides noise of each sample.
struct OffLines {
  double rows = 0.0, columns = 0.0;
};

inline Version withOffsets(const SeenShape& seen, const FitField& of, double noise, const OffLines& off,
                           std::uint64_t seed) {
  std::mt19937_64 random(seed + 1000);
  std::normal_distribution<double> normal;
  std::vector<double> rows(static_cast<std::size_t>(of.height)), columns(static_cast<std::size_t>(of.width));
  for (double& each : rows) each = off.rows * normal(random);
  for (double& each : columns) each = off.columns * normal(random);
  return fieldWith(
      of,
      [&](double x, double y) {
        return heightOn(seen.shape, x, y, seen.low, seen.high) +
               rows[static_cast<std::size_t>(std::lround(y / of.spacing_y))] +
               columns[static_cast<std::size_t>(std::lround(x / of.spacing_x))];
      },
      noise, seed);
}

}  // namespace fettle::engine
