#include "engine/measure/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <glm/geometric.hpp>

#include "engine/field/builder.h"
#include "engine/measure/fit_choice.h"
#include "engine/measure/fit_lines.h"
#include "engine/measure/fit_relation.h"
#include "tests/support/coverage.h"

namespace fettle::engine {
namespace {

using tests::countsCoverage;
using tests::Coverage;
using tests::coverageSeeds;

constexpr double kFitHole = std::numeric_limits<double>::quiet_NaN();
constexpr double kFitDegree = std::numbers::pi / 180.0;

// Heights of a shape over (x, y), by bisection along z between two bounds: a plain twin of what is fitted.
double heightOn(const Shape& shape, double x, double y, double low, double high) {
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

Version fieldWith(const FitField& of, const std::function<double(double, double)>& z, double noise = 0.0,
                  std::uint64_t seed = 1) {
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

FitRegion wholeOf(const Version& field) {
  JobControl job;
  auto region = wholeRegion(field, Region::kAll, job);
  return region ? *std::move(region) : FitRegion{};
}

Result<ShapeFit> fitOf(const Version& field, ShapeKind kind, const FitOptions& options = {}) {
  JobControl job;
  return fitShape(FitSamples(field, wholeOf(field)), kind, options, job);
}

TEST(Fit, SaysWhatItIsDoing) {
  const Version field = fieldWith({}, [](double x, double y) { return 0.1 * x - 0.2 * y; });
  const FitRegion region = wholeOf(field);
  JobControl job;
  ASSERT_TRUE(fitShape(FitSamples(field, region), ShapeKind::kPlane, {}, job));
  EXPECT_STREQ(job.stage(), "fitting");
}

// A part of each shape as seen from above, 6 x 5 mm around (3, 2.5); the bounds of z for heightOn.
struct SeenShape {
  std::string name;
  Shape shape;
  double low = -50.0, high = 50.0;
};
std::vector<SeenShape> seenShapes() {
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

Version seenField(const SeenShape& seen, double noise = 0.0, std::uint64_t seed = 1,
                  const FitField& of = {}) {
  return fieldWith(
      of, [&](double x, double y) { return heightOn(seen.shape, x, y, seen.low, seen.high); }, noise, seed);
}

double directionOff(const Shape& a, const Shape& b) {
  return glm::length(glm::cross(a.direction, b.direction));
}

// Samples of a shape, rounded to float (2^-22 of a height of up to 4), are fitted to what rounding lets through.
TEST(Fit, FindsEachShapeFromItsExactSamples) {
  for (const SeenShape& seen : seenShapes()) {
    const Version field = seenField(seen);
    for (const bool robust : {false, true})
      for (const bool vertical : {false, true}) {
        const auto fit = fitOf(field, seen.shape.kind, {.vertical = vertical, .robust = robust});
        ASSERT_TRUE(fit) << seen.name << ' ' << fit.error().line();
        EXPECT_LT(fit->rms_mm, 1e-6) << seen.name;
        EXPECT_NEAR(fit->shape.radius, seen.shape.radius, 2e-5) << seen.name;
        EXPECT_NEAR(fit->shape.tube_radius, seen.shape.tube_radius, 2e-5) << seen.name;
        EXPECT_NEAR(fit->shape.half_angle, seen.shape.half_angle, 1e-6) << seen.name;
        EXPECT_EQ(fit->shape.hollow, seen.shape.hollow) << seen.name;
        if (seen.shape.kind != ShapeKind::kSphere) {
          EXPECT_LT(directionOff(fit->shape, seen.shape), 2e-6) << seen.name;
        }
        if (seen.shape.kind == ShapeKind::kSphere || seen.shape.kind == ShapeKind::kCone ||
            seen.shape.kind == ShapeKind::kTorus) {
          EXPECT_LT(glm::length(fit->shape.point - seen.shape.point), 3e-5) << seen.name;
        } else {
          EXPECT_NEAR(distanceFrom(seen.shape, fit->shape.point), distanceFrom(seen.shape, seen.shape.point),
                      2e-5);
        }
      }
  }
}

// The family's distances are those of the plain formulas, and its derivatives those of small differences.
TEST(Fit, DistancesAndTheirSlopesAreThoseOfThePlainTwin) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> place(0.0, 6.0);
  for (const SeenShape& seen : seenShapes())
    for (int k = 0; k < 200; ++k) {
      const double x = place(random), y = place(random), z = heightOn(seen.shape, x, y, seen.low, seen.high);
      if (std::isnan(z)) continue;
      const glm::dvec3 p(x, y, z + 0.2 * (place(random) - 3.0) / 3.0);
      // Of a cone beyond its apex the two lines differ.
      if (seen.name == "countersink" && glm::length(p - seen.shape.point) < 0.5) continue;
      const FitSurface surface =
          FitSurface::of(seen.shape, {4.5, 3.0, heightOn(seen.shape, 4.5, 3.0, seen.low, seen.high)});
      const FitSurface::At at = surface.at(p);
      EXPECT_NEAR(at.distance, distanceFrom(seen.shape, p), 1e-12) << seen.name;
      EXPECT_NEAR(glm::length(at.gradient), 1.0, 1e-9) << seen.name;
      constexpr double kStep = 1e-6;
      for (double FitSurface::*number : {&FitSurface::theta, &FitSurface::ring, &FitSurface::tube}) {
        FitSurface up = surface, down = surface;
        up.*number += kStep;
        down.*number -= kStep;
        const double slope = (up.at(p).distance - down.at(p).distance) / (2.0 * kStep);
        const double stated = number == &FitSurface::theta  ? at.by_theta
                              : number == &FitSurface::ring ? at.by_ring
                                                            : at.by_tube;
        EXPECT_NEAR(stated, slope, 1e-6 * (1.0 + std::abs(slope))) << seen.name;
      }
      for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 more = p, less = p;
        more[axis] += kStep;
        less[axis] -= kStep;
        EXPECT_NEAR(at.gradient[axis],
                    (surface.at(more).distance - surface.at(less).distance) / (2.0 * kStep), 1e-7);
      }
    }
}

// Simulated scans of each shape under 5 um of noise: how often the truth lies within one, two and three standard errors.
// The table of 1,000 is printed: FETTLE_TRIALS=1000 build/release/tests/engine/measure/measure_test
// --gtest_filter='FitUncertainty*'
TEST(FitUncertainty, CoversAtOneTwoAndThreeTimes) {
  struct Figure {
    const char* name;
    std::function<double(const Shape&)> value;
    std::function<double(const ShapeFit::Errors&)> error;
  };
  const Figure radius{"radius", [](const Shape& s) { return s.radius; },
                      [](const auto& e) { return e.radius; }};
  const Figure point_z{"point z", [](const Shape& s) { return s.point.z; },
                       [](const auto& e) { return e.point.z; }};
  const Figure point_x{"point x", [](const Shape& s) { return s.point.x; },
                       [](const auto& e) { return e.point.x; }};
  const Figure axis_z{"direction z", [](const Shape& s) { return s.direction.z; },
                      [](const auto& e) { return e.direction.z; }};
  const Figure tube{"tube radius", [](const Shape& s) { return s.tube_radius; },
                    [](const auto& e) { return e.tube_radius; }};
  const Figure angle{"half angle", [](const Shape& s) { return s.half_angle; },
                     [](const auto& e) { return e.half_angle; }};
  struct Case {
    std::size_t shape;
    std::vector<Figure> figures;
    FitOptions options;
  };
  const std::vector<SeenShape> seen = seenShapes();
  const std::vector<Case> cases{{0, {axis_z}, {}},
                                {1, {radius, point_z, point_x}, {}},
                                {1, {radius}, {.vertical = true}},
                                {1, {radius}, {.robust = true}},
                                {3, {radius, axis_z}, {}},
                                {3, {radius, axis_z}, {.vertical = true}},
                                {6, {angle, point_z, axis_z}, {}},
                                {7, {radius, tube, axis_z}, {}}};
  for (const Case& one : cases) {
    const SeenShape& of = seen[one.shape];
    std::vector<Coverage> covered(one.figures.size());
    for (int seed = 0; seed < coverageSeeds(); ++seed) {
      const Version field = seenField(of, 0.005, static_cast<std::uint64_t>(seed) + 1, {24, 20, 0.25, 0.25});
      FitOptions options = one.options;
      options.noise_mm = 0.005;
      const auto fit = fitOf(field, of.shape.kind, options);
      ASSERT_TRUE(fit) << of.name << ' ' << seed << ' ' << fit.error().line();
      const ShapeFit::Errors errors = fit->errors();
      for (std::size_t f = 0; f < one.figures.size(); ++f)
        covered[f].add(one.figures[f].value(fit->shape) - one.figures[f].value(of.shape),
                       one.figures[f].error(errors));
    }
    for (std::size_t f = 0; f < one.figures.size(); ++f) {
      std::printf("%-10s %-10s %-7s %-12s %s  error %.3g, stated %.3g\n", of.name.c_str(),
                  one.options.vertical ? "vertical" : "orthogonal", one.options.robust ? "robust" : "",
                  one.figures[f].name, covered[f].counts().c_str(), covered[f].rms(), covered[f].stated());
      if (countsCoverage()) {
        EXPECT_EQ(covered[f].complaint(), "") << of.name << ' ' << one.figures[f].name;
      }
    }
  }
}

// What a whole row or column is off, besides noise of each sample.
struct OffLines {
  double rows = 0.0, columns = 0.0;
};

Version withOffsets(const SeenShape& seen, const FitField& of, double noise, const OffLines& off,
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

// Each shape under noise of rows, of columns and of both: along the lines and across them errors differ by the root of the
// samples of a line.
TEST(FitUncertainty, CoversUnderNoiseOfRowsAndColumns) {
  struct Figure {
    const char* name;
    std::function<double(const Shape&)> value;
    std::function<double(const ShapeFit::Errors&)> error;
  };
  const Figure axis_x{"direction x", [](const Shape& s) { return s.direction.x; },
                      [](const auto& e) { return e.direction.x; }};
  const Figure axis_y{"direction y", [](const Shape& s) { return s.direction.y; },
                      [](const auto& e) { return e.direction.y; }};
  const Figure point_x{"point x", [](const Shape& s) { return s.point.x; },
                       [](const auto& e) { return e.point.x; }};
  const Figure point_y{"point y", [](const Shape& s) { return s.point.y; },
                       [](const auto& e) { return e.point.y; }};
  const Figure radius{"radius", [](const Shape& s) { return s.radius; },
                      [](const auto& e) { return e.radius; }};
  const Figure angle{"half angle", [](const Shape& s) { return s.half_angle; },
                     [](const auto& e) { return e.half_angle; }};
  const Figure tube{"tube radius", [](const Shape& s) { return s.tube_radius; },
                    [](const auto& e) { return e.tube_radius; }};
  struct Case {
    std::size_t shape;
    OffLines off;
    std::vector<Figure> figures;
    FitOptions options;
  };
  const OffLines rows{5e-4, 0.0}, columns{0.0, 5e-4}, both{2e-4, 5e-4}, loud{5e-3, 0.0};
  const std::vector<Case> cases{{0, rows, {axis_x, axis_y}, {}},
                                {0, columns, {axis_x, axis_y}, {}},
                                {0, both, {axis_x, axis_y}, {}},
                                {0, loud, {axis_x, axis_y}, {.vertical = true}},
                                {0, rows, {axis_x, axis_y}, {.robust = true}},
                                {0, loud, {axis_x, axis_y}, {.vertical = true, .robust = true}},
                                {1, rows, {radius, point_x, point_y}, {}},
                                {1, columns, {radius, point_x, point_y}, {.vertical = true}},
                                {3, both, {radius, axis_y}, {}},
                                {6, rows, {angle, point_x, point_y}, {}},
                                {7, rows, {radius, tube, axis_x, axis_y}, {}}};
  // Of 41 rows: the size of their offsets is known, what they are is not.
  const FitField field{51, 41, 6.0 / 50.0, 5.0 / 40.0};
  constexpr double kWhite = 1e-4;
  const std::vector<SeenShape> seen = seenShapes();
  for (const Case& one : cases) {
    const SeenShape& of = seen[one.shape];
    std::vector<Coverage> covered(one.figures.size());
    for (int seed = 0; seed < coverageSeeds(); ++seed) {
      const Version scan = withOffsets(of, field, kWhite, one.off, static_cast<std::uint64_t>(seed) + 1);
      FitOptions options = one.options;
      options.noise_mm = kWhite;
      options.rows_mm = one.off.rows;
      options.columns_mm = one.off.columns;
      const auto fit = fitOf(scan, of.shape.kind, options);
      ASSERT_TRUE(fit) << of.name << ' ' << seed << ' ' << fit.error().line();
      const ShapeFit::Errors errors = fit->errors();
      for (std::size_t f = 0; f < one.figures.size(); ++f)
        covered[f].add(one.figures[f].value(fit->shape) - one.figures[f].value(of.shape),
                       one.figures[f].error(errors));
    }
    for (std::size_t f = 0; f < one.figures.size(); ++f) {
      std::printf("%-10s rows %.0f columns %.0f %-7s %-12s %s  error %.3g, stated %.3g\n", of.name.c_str(),
                  one.off.rows / kWhite, one.off.columns / kWhite, one.options.robust ? "robust" : "",
                  one.figures[f].name, covered[f].counts().c_str(), covered[f].rms(), covered[f].stated());
      if (!countsCoverage()) continue;
      EXPECT_EQ(covered[f].complaint(), "") << of.name << ' ' << one.figures[f].name;
      EXPECT_LE(covered[f].stated(), 1.5 * covered[f].rms()) << of.name << ' ' << one.figures[f].name;
    }
  }
}

// Sums by rows and columns against the covariance matrix of all samples, and the fit itself, which no noise changes.
TEST(Fit, NoiseOfLinesIsSummedAsItsMatrixHasIt) {
  const SeenShape seen = seenShapes()[7];
  const FitField of{23, 19, 6.0 / 22.0, 5.0 / 18.0};
  const Version field = withOffsets(seen, of, 0.002, {0.004, 0.003}, 5);
  const auto fit = fitOf(field, ShapeKind::kTorus, {.noise_mm = 0.002});
  const auto with =
      fitOf(field, ShapeKind::kTorus, {.noise_mm = 0.002, .rows_mm = 0.004, .columns_mm = 0.003});
  ASSERT_TRUE(fit && with);
  EXPECT_EQ(fit->shape.radius, with->shape.radius);
  EXPECT_EQ(fit->shape.point, with->shape.point);
  EXPECT_EQ(fit->rms_mm, with->rms_mm);
  EXPECT_NE(fit->covariance, with->covariance);

  const FitSamples samples(field, wholeOf(field));
  const FitPoints points{&samples, fit->scale};
  const FitModel model{ShapeKind::kTorus, fit->surface};
  const FitNoise noise{1.0, 3.0, 2.0};
  const FitLineSums sums(points, {}, model);
  FitTerms terms(model, {});
  std::vector<Eigen::VectorXd> rows;
  std::vector<std::pair<int, int>> places;
  FitSamples::Block block;
  for (std::size_t b = 0; b < samples.blocks(); ++b) {
    samples.read(b, block);
    for (int i = 0; i < block.count; ++i) {
      ASSERT_TRUE(terms.take(block.points[static_cast<std::size_t>(i)] / fit->scale));
      rows.emplace_back(terms.cosine * terms.row);
      places.emplace_back(block.column + i, block.row);
    }
  }
  ASSERT_GT(rows.size(), 300U);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(7, 7);
  for (std::size_t a = 0; a < rows.size(); ++a)
    for (std::size_t b = 0; b < rows.size(); ++b) {
      const double covariance = (a == b ? noise.sample : 0.0) +
                                (places[a].second == places[b].second ? noise.rows : 0.0) +
                                (places[a].first == places[b].first ? noise.columns : 0.0);
      expected += covariance * rows[a] * rows[b].transpose();
    }
  EXPECT_LT((sums.covariance(noise) - expected).norm(), 1e-11 * expected.norm());
}

// Two planes: the angle and the distance between them under the same noise.
TEST(FitUncertainty, CoversOfAngleAndDistance) {
  Coverage of_angle, of_distance;
  const double slope = std::tan(30.0 * kFitDegree);
  for (int seed = 0; seed < coverageSeeds(); ++seed) {
    const auto plane = [&](double rise, double up, int which) {
      return fitOf(fieldWith(
                       {20, 20, 0.25, 0.25}, [&](double x, double) { return rise * x + up; }, 0.005,
                       static_cast<std::uint64_t>(2 * seed + which)),
                   ShapeKind::kPlane, {.noise_mm = 0.005});
    };
    const auto level = plane(0.0, 0.0, 0), tilted = plane(slope, 0.0, 1), above = plane(0.0, 1.0, 1);
    ASSERT_TRUE(level && tilted && above);
    const ShapeRelation turned = relationOf(*level, *tilted), step = relationOf(*level, *above);
    of_angle.add(turned.angle_deg.value - 30.0, turned.angle_deg.error);
    of_distance.add(step.distance_mm.value - 1.0, step.distance_mm.error);
  }
  for (const auto& [name, covered] : {std::pair("angle", of_angle), std::pair("distance", of_distance)}) {
    std::printf("%-10s %s\n", name, covered.counts().c_str());
    if (countsCoverage()) {
      EXPECT_EQ(covered.complaint(), "") << name;
    }
  }
}

// The least squares of heights themselves, of a plane as by its own normal equations, of a ball by a look around it.
TEST(Fit, VerticalDistancesAreThoseAlongZ) {
  const Version steep = fieldWith(
      {30, 20, 0.1, 0.1}, [](double x, double y) { return x - 0.3 * y; }, 0.05);
  const auto plane = fitOf(steep, ShapeKind::kPlane, {.vertical = true, .noise_mm = 0.05});
  ASSERT_TRUE(plane);
  Eigen::Matrix3d sums = Eigen::Matrix3d::Zero();
  Eigen::Vector3d with_z = Eigen::Vector3d::Zero();
  const auto everySample = [](const Version& field, const auto& use) {
    for (int r = 0; r < field.grid().height; ++r)
      for (int c = 0; c < field.grid().width; ++c) {
        float z = 0.0F;
        field.reader().readHeights(c, r, 1, 1, &z, 1);
        use(glm::dvec3(c * field.grid().spacing_x, r * field.grid().spacing_y, double{z}));
      }
  };
  everySample(steep, [&](const glm::dvec3& p) {
    const Eigen::Vector3d row(1.0, p.x, p.y);
    sums += row * row.transpose();
    with_z += p.z * row;
  });
  const Eigen::Vector3d own = sums.ldlt().solve(with_z);
  const glm::dvec3 n = plane->shape.direction;
  EXPECT_NEAR(-n.x / n.z, own[1], 1e-9);
  EXPECT_NEAR(-n.y / n.z, own[2], 1e-9);
  // Orthogonal distances make the slope larger: by 12 times the square of noise over length, times what it rises.
  const auto nearest = fitOf(steep, ShapeKind::kPlane, {.noise_mm = 0.05});
  ASSERT_TRUE(nearest);
  EXPECT_GT(-nearest->shape.direction.x / nearest->shape.direction.z, own[1] + 1e-3);

  const Version cap = fieldWith(
      {40, 40, 0.1, 0.1},
      [](double x, double y) { return std::sqrt(6.25 - (x - 2) * (x - 2) / 1.6 - (y - 2) * (y - 2) / 1.6); },
      0.02);
  const auto ball = fitOf(cap, ShapeKind::kSphere, {.vertical = true, .noise_mm = 0.02});
  ASSERT_TRUE(ball);
  const auto squares = [&](const glm::dvec3& centre, double radius) {
    double sum = 0.0;
    everySample(cap, [&](const glm::dvec3& p) {
      const double across = (p.x - centre.x) * (p.x - centre.x) + (p.y - centre.y) * (p.y - centre.y);
      sum += std::pow(p.z - centre.z - std::sqrt(radius * radius - across), 2);
    });
    return sum;
  };
  const glm::dvec3 centre = ball->shape.point;
  const double least = squares(centre, ball->shape.radius);
  EXPECT_NEAR(std::sqrt(least / 1600.0), ball->rms_mm, 1e-9);
  for (const double by : {-1e-5, 1e-5}) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 moved = centre;
      moved[axis] += by;
      EXPECT_GT(squares(moved, ball->shape.radius), least) << axis;
    }
    EXPECT_GT(squares(centre, ball->shape.radius + by), least);
  }
}

// Tilts of steep planes: the error of an angle is that of the slope less the slope's own squares, once.
TEST(FitUncertainty, CoversTiltsOfSteepPlanes) {
  Coverage of_x, of_y;
  for (int seed = 0; seed < coverageSeeds(); ++seed) {
    const auto plane = fitOf(fieldWith(
                                 {20, 20, 0.25, 0.25}, [](double x, double y) { return 1.5 * x - 0.5 * y; },
                                 0.005, static_cast<std::uint64_t>(seed)),
                             ShapeKind::kPlane, {.noise_mm = 0.005});
    ASSERT_TRUE(plane);
    const glm::dvec3 n = plane->shape.direction;
    const ShapeFit::Errors e = plane->errors();
    of_x.add(std::atan(-n.x / n.z) - std::atan(1.5), e.tilt_x);
    of_y.add(std::atan(-n.y / n.z) + std::atan(0.5), e.tilt_y);
  }
  for (const auto& [name, covered] : {std::pair("tilt x", of_x), std::pair("tilt y", of_y)}) {
    std::printf("%-10s %s\n", name, covered.counts().c_str());
    if (countsCoverage()) {
      EXPECT_EQ(covered.complaint(), "") << name;
    }
  }
}

// Noise that 3 x 3 neighbours share: the scatter of sums over parts of the region says so.
TEST(FitUncertainty, CountsNoiseThatNeighboursShare) {
  const SeenShape of = seenShapes()[3];
  int once = 0;
  double correlation = 0.0;
  const int seeds = std::min(coverageSeeds(), 200);
  for (int seed = 0; seed < seeds; ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed) + 1);
    std::normal_distribution<double> normal(0.0, 0.015);
    std::vector<double> white(62 * 62);
    for (double& w : white) w = normal(random);
    const Version field = fieldWith({60, 60, 0.1, 0.083}, [&](double x, double y) {
      const auto c = static_cast<std::size_t>(std::lround(x / 0.1)),
                 r = static_cast<std::size_t>(std::lround(y / 0.083));
      double sum = 0.0;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) sum += white[(r + i) * 62 + c + j] / 9.0;
      return heightOn(of.shape, x, y, of.low, of.high) + sum;
    });
    const auto fit = fitOf(field, ShapeKind::kCylinder, {.noise_mm = 0.001});
    ASSERT_TRUE(fit);
    once += std::abs(fit->shape.radius - of.shape.radius) <= fit->errors().radius ? 1 : 0;
    correlation += fit->correlation / seeds;
  }
  std::printf("shared by 3 x 3: %d of %d within one error, variance times %.2f\n", once, seeds, correlation);
  if (!countsCoverage()) return;
  // As many as of independent noise, less four in a hundred for what parts of five samples do not see: of 200 109.
  EXPECT_GE(once, seeds * (0.683 - 0.04) - 3.0 * std::sqrt(seeds * 0.68 * 0.32));
  // Without it a third of the error: the variance of a mean grows ninefold.
  EXPECT_GT(correlation, 4.0);
}

TEST(Fit, IsTheSameForAnyNumberOfThreads) {
  const Version field = seenField(seenShapes()[7], 0.005, 3, {150, 120, 0.04, 0.04});
  for (const bool robust : {false, true}) {
    std::vector<double> numbers;
    for (const std::size_t threads : {1, 2, 5}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      const auto fit =
          fitOf(field, ShapeKind::kTorus, {.robust = robust, .rows_mm = 0.001, .columns_mm = 0.002});
      ASSERT_TRUE(fit) << fit.error().line();
      const std::vector<double> these{fit->shape.radius, fit->shape.point.x, fit->covariance[0],
                                      fit->correlation};
      if (numbers.empty()) numbers = these;
      EXPECT_EQ(these, numbers);
    }
  }
}

// What holds other things than the shape: spikes of 1e6, a step, holes.
TEST(Fit, RobustIgnoresSpikesStepsAndHoles) {
  for (const SeenShape& seen : seenShapes()) {
    const Version field = fieldWith(
        {60, 50, 0.1, 0.1},
        [&](double x, double y) {
          const double z = heightOn(seen.shape, x, y, seen.low, seen.high);
          const int c = static_cast<int>(std::lround(x / 0.1)), r = static_cast<int>(std::lround(y / 0.1));
          if ((3 * c + 7 * r) % 41 == 0) return 1e6;
          if ((c + r) % 23 == 0) return kFitHole;
          return x > 4.6 && y > 3.2 ? z + 0.7 : z;
        },
        0.002);
    const auto fit = fitOf(field, seen.shape.kind, {.vertical = true, .robust = true, .noise_mm = 0.002});
    ASSERT_TRUE(fit) << seen.name << ' ' << fit.error().line();
    const ShapeFit::Errors errors = fit->errors();
    EXPECT_NEAR(fit->shape.radius, seen.shape.radius, 5.0 * errors.radius) << seen.name;
    EXPECT_NEAR(fit->shape.tube_radius, seen.shape.tube_radius, 5.0 * errors.tube_radius) << seen.name;
    EXPECT_NEAR(fit->shape.half_angle, seen.shape.half_angle, 5.0 * errors.half_angle) << seen.name;
    EXPECT_NEAR(fit->rms_mm, 0.002, 4e-4) << seen.name;
    EXPECT_GT(fit->left_out, 100) << seen.name;
  }
}

// The spacing in y four times that in x; all far from 0: the origin of the grid is not used, heights at 4,000 mm are
// floats 2.4e-4 apart.
TEST(Fit, HoldsAtUnequalSpacingAndGreatHeights) {
  const SeenShape seen = seenShapes()[1];
  const Version unequal = seenField(seen, 0.0, 1, {120, 13, 0.05, 0.4});
  const auto fit = fitOf(unequal, ShapeKind::kSphere);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->shape.radius, 6.0, 2e-5);
  const Version high = fieldWith({60, 50, 0.1, 0.1}, [&](double x, double y) {
    return 4000.0 + heightOn(seen.shape, x, y, seen.low, seen.high);
  });
  const auto far = fitOf(high, ShapeKind::kSphere);
  ASSERT_TRUE(far);
  EXPECT_NEAR(far->shape.radius, 6.0, 5.0 * far->errors().radius);
  EXPECT_GT(far->errors().radius, 1e-6);
}

TEST(Fit, RefusesByNameWhatTheSamplesDoNotDetermine) {
  const auto flat = [](double x, double) { return 0.1 * x; };
  const FitField small{3, 1, 1.0, 1.0}, row{50, 1, 0.1, 0.1}, usual{};
  struct Refusal {
    Version field;
    ShapeKind kind;
    const char* text;
  };
  const Version ball = seenField(seenShapes()[1], 0.002), cylinder = seenField(seenShapes()[3], 0.002);
  for (const Refusal& one :
       {Refusal{fieldWith(small, flat), ShapeKind::kSphere, "3 samples for 4 numbers"},
        {fieldWith(small, flat), ShapeKind::kPlane, "direction"},
        {fieldWith(row, flat), ShapeKind::kPlane, "direction"},
        {fieldWith(row, [](double x, double) { return std::sin(x); }), ShapeKind::kCylinder,
         "do not determine"},
        {fieldWith(usual, flat, 0.002), ShapeKind::kSphere, "a radius"},
        {fieldWith(usual, flat, 0.002), ShapeKind::kCylinder, "a radius"},
        {fieldWith(usual, flat), ShapeKind::kCylinder, "do not determine"},
        {fieldWith(usual, flat, 0.002), ShapeKind::kCone, "do not determine"},
        {fieldWith(usual, flat, 0.002), ShapeKind::kTorus, "do not determine"},
        {cylinder, ShapeKind::kCone, "an apex"},
        {cylinder, ShapeKind::kTorus, "do not determine"},
        {ball, ShapeKind::kTorus, "do not determine"},
        {fieldWith(usual, [](double, double) { return kFitHole; }), ShapeKind::kPlane, "0 samples"}}) {
    const auto fit = fitOf(one.field, one.kind, {.noise_mm = 0.002});
    ASSERT_FALSE(fit) << one.text << ' ' << static_cast<int>(one.kind) << ' ' << fit->shape.radius;
    EXPECT_NE(fit.error().what.find(one.text), std::string::npos) << fit.error().line();
  }
  // Three samples that are not on a line determine a plane; their noise gives it an error.
  const auto three =
      fitOf(fieldWith({2, 2, 1.0, 1.0}, [](double x, double y) { return x + y > 1.5 ? kFitHole : x; }),
            ShapeKind::kPlane, {.noise_mm = 0.01});
  ASSERT_TRUE(three) << three.error().line();
  EXPECT_NEAR(three->shape.direction.x, -std::sqrt(0.5), 1e-6);
  EXPECT_GT(three->errors().direction.x, 1e-3);
  // Without it there is nothing that an error could be made of.
  const auto unknown =
      fitOf(fieldWith({2, 2, 1.0, 1.0}, [](double x, double y) { return x + y > 1.5 ? kFitHole : x; }),
            ShapeKind::kPlane, {.noise_mm = kFitHole});
  ASSERT_TRUE(unknown) << unknown.error().line();
  EXPECT_NEAR(unknown->shape.direction.x, -std::sqrt(0.5), 1e-6);
  EXPECT_TRUE(std::isnan(unknown->errors().direction.x));
  EXPECT_TRUE(std::isnan(unknown->errors().point.z));
}

TEST(Fit, AutomaticTakesTheSimplestShapeThatHolds) {
  JobControl job;
  const std::vector<ShapeKind> all{ShapeKind::kPlane, ShapeKind::kSphere, ShapeKind::kCylinder,
                                   ShapeKind::kCone, ShapeKind::kTorus};
  for (const SeenShape& seen : seenShapes())
    for (std::uint64_t seed = 1; seed < 4; ++seed) {
      const Version field = seenField(seen, 0.005, seed);
      const auto chosen = fitBestShape(field, wholeOf(field), all, {.noise_mm = 0.005}, job);
      ASSERT_TRUE(chosen);
      EXPECT_EQ(chosen->fit.shape.kind, seen.shape.kind)
          << seen.name << ' ' << infoOf(chosen->fit.shape.kind).word;
    }
  // A tenth of the noise of curvature over the field is a plane.
  const Version nearly = fieldWith(
      {}, [](double x, double y) { return 2e-4 * ((x - 3) * (x - 3) - y * y); }, 0.005);
  const auto chosen = fitBestShape(nearly, wholeOf(nearly), all, {.noise_mm = 0.005}, job);
  ASSERT_TRUE(chosen);
  EXPECT_EQ(chosen->fit.shape.kind, ShapeKind::kPlane);
}

// A roof of two planes with an edge line on its ridge, drawn by hand, and a gap in it.
TEST(FitRegions, LieBetweenLines) {
  const Version field = fieldWith({40, 30, 1.0, 1.0}, [](double x, double) { return -std::abs(x - 20.0); });
  EdgeLine line;
  for (int r = -1; r < 31; ++r)
    if (r < 10 || r > 12) line.points.push_back({.position = {20.0, static_cast<double>(r)}});
  JobControl job;
  const std::vector<EdgeLine> whole{line};
  const auto regions = regionsBetween(field, whole, {.margin = 2.0}, job);
  ASSERT_TRUE(regions);
  ASSERT_EQ(regions->size(), 2U);
  // Columns 0 to 17 and 23 to 39.
  EXPECT_EQ((*regions)[0].samples, 18 * 30);
  EXPECT_EQ((*regions)[1].samples, 17 * 30);
  EXPECT_EQ(regionAt(*regions, {5.0, 5.0}), 0);
  EXPECT_EQ(regionAt(*regions, {30.2, 29.0}), 1);
  EXPECT_EQ(regionAt(*regions, {20.0, 5.0}), -1);
  EXPECT_EQ(regionAt(*regions, {-5.0, 500.0}), -1);
  // Two pieces with a gap of four samples between them: closed by a margin of 2, open with one of 1.
  std::vector<EdgeLine> pieces(2);
  for (const EdgePoint& p : line.points) pieces[p.position.y < 11.0 ? 0 : 1].points.push_back(p);
  EXPECT_EQ(regionsBetween(field, pieces, {.margin = 2.0}, job)->size(), 2U);
  EXPECT_EQ(regionsBetween(field, pieces, {.margin = 1.0}, job)->size(), 1U);
  EXPECT_EQ(regionsBetween(field, pieces, {.margin = 2.0, .least = 520}, job)->size(), 1U);
  const auto left = fitShape(FitSamples(field, (*regions)[0]), ShapeKind::kPlane, {}, job);
  ASSERT_TRUE(left);
  EXPECT_NEAR(left->shape.direction.x, -std::sqrt(0.5), 1e-7);
}

// Lines in any direction, closed ones and a single point, against the distance of every sample from every segment.
TEST(FitRegions, AreAllSamplesFartherThanTheMarginFromEveryLine) {
  const Version field = fieldWith({70, 50, 1.0, 1.0}, [](double x, double y) { return 0.1 * x + 0.05 * y; });
  const auto lineOf = [](const std::vector<glm::dvec2>& points, bool closed) {
    EdgeLine line;
    line.closed = closed;
    for (const glm::dvec2& p : points) line.points.push_back({.position = p});
    return line;
  };
  const std::vector<EdgeLine> lines{lineOf({{-5.0, 3.3}, {20.2, 31.7}, {26.1, 60.0}}, false),
                                    lineOf({{40.4, 10.1}, {61.7, 18.3}, {52.2, 39.9}, {38.8, 30.2}}, true),
                                    lineOf({{66.0, 46.0}}, false),
                                    lineOf({{30.0, 45.0}, {36.0, 45.0}}, false)};
  for (const double margin : {1.1, 2.6}) {
    const auto covered = [&](const glm::dvec2& at) {
      for (const EdgeLine& line : lines) {
        const std::size_t n = line.points.size();
        for (std::size_t i = 0; i < n; ++i) {
          if (!line.closed && i + 1 == n && n > 1) continue;
          const glm::dvec2 a = line.points[i].position, way = line.points[(i + 1) % n].position - a;
          const double square = glm::dot(way, way);
          const double share = square > 0.0 ? std::clamp(glm::dot(at - a, way) / square, 0.0, 1.0) : 0.0;
          if (glm::length(at - a - share * way) <= margin) return true;
        }
      }
      return false;
    };
    JobControl job;
    const auto regions = regionsBetween(field, lines, {.margin = margin, .least = 1}, job);
    ASSERT_TRUE(regions);
    std::int64_t free = 0, found = 0;
    for (int r = 0; r < 50; ++r)
      for (int c = 0; c < 70; ++c) {
        const glm::dvec2 at(c, r);
        free += covered(at) ? 0 : 1;
        EXPECT_EQ(regionAt(*regions, at) < 0, covered(at)) << c << ' ' << r;
      }
    for (const auto& region : *regions) found += region.samples;
    EXPECT_EQ(found, free);
    EXPECT_GE(regions->size(), 3U) << "within the ring, and on both sides of the line";
    EXPECT_EQ(job.done(), job.total());
  }
}

}  // namespace
}  // namespace fettle::engine
