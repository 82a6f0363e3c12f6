// Standard errors of fitted shapes against simulated scans.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/measure/fit.h"
#include "engine/measure/fit_relation.h"
#include "engine/measure/fit_shape.h"
#include "tests/engine/measure/seen_shapes.h"
#include "tests/support/coverage.h"

namespace fettle::engine {
namespace {

using tests::countsCoverage;
using tests::Coverage;
using tests::coverageSeeds;

// A number of a shape and its standard error.
struct ShapeFigure {
  const char* name;
  std::function<double(const Shape&)> value;
  std::function<double(const ShapeFit::Errors&)> error;
};

// How often the truth lies within the errors of each figure, over seeds of `scanOf`.
std::vector<Coverage> coveredBy(const SeenShape& of, const std::vector<ShapeFigure>& figures,
                                const FitOptions& options,
                                const std::function<Version(std::uint64_t seed)>& scanOf) {
  std::vector<Coverage> covered(figures.size());
  for (int seed = 0; seed < coverageSeeds(); ++seed) {
    const auto fit = fitOf(scanOf(static_cast<std::uint64_t>(seed) + 1), of.shape.kind, options);
    if (!fit) {
      ADD_FAILURE() << of.name << ' ' << seed << ' ' << fit.error().line();
      return covered;
    }
    const ShapeFit::Errors errors = fit->errors();
    for (std::size_t f = 0; f < figures.size(); ++f)
      covered[f].add(figures[f].value(fit->shape) - figures[f].value(of.shape), figures[f].error(errors));
  }
  return covered;
}

// Simulated scans of each shape under 5 um of noise: how often the truth lies within one, two and three standard errors.
// The table of 1,000 is printed: FETTLE_TRIALS=1000 build/release/tests/engine/measure/measure_test
// --gtest_filter='FitUncertainty*'
TEST(FitUncertainty, CoversAtOneTwoAndThreeTimes) {
  const ShapeFigure radius{"radius", [](const Shape& s) { return s.radius; },
                           [](const auto& e) { return e.radius; }};
  const ShapeFigure point_z{"point z", [](const Shape& s) { return s.point.z; },
                            [](const auto& e) { return e.point.z; }};
  const ShapeFigure point_x{"point x", [](const Shape& s) { return s.point.x; },
                            [](const auto& e) { return e.point.x; }};
  const ShapeFigure axis_z{"direction z", [](const Shape& s) { return s.direction.z; },
                           [](const auto& e) { return e.direction.z; }};
  const ShapeFigure tube{"tube radius", [](const Shape& s) { return s.tube_radius; },
                         [](const auto& e) { return e.tube_radius; }};
  const ShapeFigure angle{"half angle", [](const Shape& s) { return s.half_angle; },
                          [](const auto& e) { return e.half_angle; }};
  struct Case {
    std::size_t shape;
    std::vector<ShapeFigure> figures;
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
    FitOptions options = one.options;
    options.noise_mm = 0.005;
    const auto covered = coveredBy(of, one.figures, options, [&](std::uint64_t seed) {
      return seenField(of, 0.005, seed, {24, 20, 0.25, 0.25});
    });
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

// Each shape under noise of rows, of columns and of both: along the lines and across them errors differ by the root of the
// samples of a line.
TEST(FitUncertainty, CoversUnderNoiseOfRowsAndColumns) {
  const ShapeFigure axis_x{"direction x", [](const Shape& s) { return s.direction.x; },
                           [](const auto& e) { return e.direction.x; }};
  const ShapeFigure axis_y{"direction y", [](const Shape& s) { return s.direction.y; },
                           [](const auto& e) { return e.direction.y; }};
  const ShapeFigure point_x{"point x", [](const Shape& s) { return s.point.x; },
                            [](const auto& e) { return e.point.x; }};
  const ShapeFigure point_y{"point y", [](const Shape& s) { return s.point.y; },
                            [](const auto& e) { return e.point.y; }};
  const ShapeFigure radius{"radius", [](const Shape& s) { return s.radius; },
                           [](const auto& e) { return e.radius; }};
  const ShapeFigure angle{"half angle", [](const Shape& s) { return s.half_angle; },
                          [](const auto& e) { return e.half_angle; }};
  const ShapeFigure tube{"tube radius", [](const Shape& s) { return s.tube_radius; },
                         [](const auto& e) { return e.tube_radius; }};
  struct Case {
    std::size_t shape;
    OffLines off;
    std::vector<ShapeFigure> figures;
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
    FitOptions options = one.options;
    options.noise_mm = kWhite;
    options.rows_mm = one.off.rows;
    options.columns_mm = one.off.columns;
    const auto covered = coveredBy(of, one.figures, options, [&](std::uint64_t seed) {
      return withOffsets(of, field, kWhite, one.off, seed);
    });
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

// A plane's point is its height over the middle of the samples: noise moves z alone. A tenth of the heights is raised in half of the
// scans, which moves the median height and, robustly, not the plane: the foot of the median would move along it.
TEST(FitUncertainty, CoversTheHeightOfAPlanesPoint) {
  for (const bool steep : {false, true})
    for (const bool robust : {false, true}) {
      const double slope = steep ? 1.5 : 0.0;
      Coverage of_z;
      for (int seed = 0; seed < coverageSeeds(); ++seed) {
        const auto plane =
            fitOf(fieldWith(
                      {21, 21, 0.25, 0.25},
                      [&](double x, double y) {
                        const bool raised = robust && seed % 2 == 1 && x < 0.4;
                        return slope * (x - 2.5) - 0.5 * (y - 2.5) + 0.3 + (raised ? 9.0 : 0.0);
                      },
                      0.005, static_cast<std::uint64_t>(seed) + 1),
                  ShapeKind::kPlane, {.robust = robust, .noise_mm = 0.005});
        ASSERT_TRUE(plane) << plane.error().line();
        EXPECT_DOUBLE_EQ(plane->shape.point.x, 2.5);
        EXPECT_DOUBLE_EQ(plane->shape.point.y, 2.5);
        const ShapeFit::Errors e = plane->errors();
        EXPECT_EQ(e.point.x, 0.0);
        EXPECT_EQ(e.point.y, 0.0);
        of_z.add(plane->shape.point.z - 0.3, e.point.z);
      }
      std::printf("plane's z %s %s %s  error %.3g, stated %.3g\n", steep ? "steep" : "flat ",
                  robust ? "robust" : "", of_z.counts().c_str(), of_z.rms(), of_z.stated());
      if (countsCoverage()) {
        EXPECT_EQ(of_z.complaint(), "") << steep << robust;
        EXPECT_NEAR(of_z.stated() / of_z.rms(), 1.0, scatterOfRms() + 0.05);
      }
    }
}

// Noise does not turn the axis of a cylinder along x, y or between them, nor the axis of a ring, over.
TEST(FitUncertainty, NoiseTurnsNoAxisOver) {
  constexpr double kHalf = 0.70710678118654752;
  for (const glm::dvec3& axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(kHalf, kHalf, 0),
                                 glm::dvec3(kHalf, -kHalf, 0), glm::dvec3(0.5, -std::sqrt(0.75), 0)}) {
    const SeenShape lying{"lying", {ShapeKind::kCylinder, {3.0, 2.5, -4.0}, axis, 6.0}, -4, 9};
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const auto fit =
          fitOf(seenField(lying, 0.02, seed, {24, 20, 0.25, 0.25}), ShapeKind::kCylinder, {.noise_mm = 0.02});
      ASSERT_TRUE(fit) << fit.error().line();
      EXPECT_GT(glm::dot(fit->shape.direction, axis), 0.9) << axis.x << ' ' << axis.y << ' ' << seed;
    }
  }
  EXPECT_EQ(inAxisSense({0, 0, -1}), glm::dvec3(0, 0, 1));
  EXPECT_EQ(inAxisSense({0.3, -0.3, -std::sqrt(0.82)}).z, std::sqrt(0.82));
}

// What noise moves figures by on average, which no error counts: of orthogonal distances as the square of the noise, whatever the number of samples.
// Stated to a tenth of the mean, where three standard deviations of the mean of so many scans are no more.
TEST(FitUncertainty, StatesWhatNoiseMovesFiguresByOnAverage) {
  using Figure = std::pair<double, double>;  // its value less the truth, and its bias
  struct Case {
    SeenShape of;
    FitField field;
    double noise;
    FitOptions options;
    const char* name;
    std::function<Figure(const ShapeFit&)> figure;
  };
  const auto radius = [](const ShapeFit& fit) { return Figure{fit.shape.radius - 6.0, fit.biases().radius}; };
  const auto tilt = [](const ShapeFit& fit) {
    return Figure{std::atan(-fit.shape.direction.x / fit.shape.direction.z) - std::atan(1.0),
                  fit.biases().tilt_x};
  };
  const auto height = [](const ShapeFit& fit) {
    return Figure{fit.shape.point.z + 4.0, fit.biases().point.z};
  };
  const SeenShape ball{"ball", {ShapeKind::kSphere, {3.0, 2.5, -4.0}, {0, 0, 1}, 6.0}, -4, 9};
  const SeenShape lying{"cylinder", {ShapeKind::kCylinder, {3.0, 2.5, -4.0}, {0, 1, 0}, 6.0}, -4, 9};
  const SeenShape slope{
      "plane", {ShapeKind::kPlane, {3.0, 2.5, 0.2}, glm::normalize(glm::dvec3(-1, 0, 1))}, -9, 9};
  const FitField whole{49, 41, 0.125, 0.125}, cap{31, 31, 0.06, 0.06};
  SeenShape top = ball;
  top.shape.point = {0.9, 0.9, -4.0};
  const std::vector<Case> cases{{ball, whole, 0.1, {}, "radius", radius},
                                {ball, whole, 0.1, {}, "centre z", height},
                                {top, cap, 0.02, {}, "radius of a cap", radius},
                                {ball, whole, 0.1, {.vertical = true}, "radius", radius},
                                {lying, whole, 0.1, {}, "radius", radius},
                                {lying, whole, 0.1, {.robust = true}, "radius", radius},
                                {slope, whole, 0.2, {}, "tilt", tilt}};
  for (const Case& one : cases) {
    double sum = 0.0, squares = 0.0, stated = 0.0;
    const int seeds = std::min(coverageSeeds(), 400);
    for (int seed = 0; seed < seeds; ++seed) {
      FitOptions options = one.options;
      options.noise_mm = one.noise;
      const auto fit = fitOf(seenField(one.of, one.noise, static_cast<std::uint64_t>(seed) + 1, one.field),
                             one.of.shape.kind, options);
      ASSERT_TRUE(fit) << fit.error().line();
      const auto [off, bias] = one.figure(*fit);
      sum += off;
      squares += off * off;
      stated += bias / seeds;
    }
    const double mean = sum / seeds, scatter = std::sqrt((squares / seeds - mean * mean) / seeds);
    std::printf("%-10s %-10s %-7s %-16s mean off %9.3g +- %.2g, stated %9.3g; error %.3g\n",
                one.of.name.c_str(), one.options.vertical ? "vertical" : "orthogonal",
                one.options.robust ? "robust" : "", one.name, mean, scatter, stated,
                scatter * std::sqrt(seeds));
    if (!countsCoverage()) continue;
    EXPECT_NEAR(stated, mean, 0.1 * std::abs(mean) + 3.0 * scatter) << one.of.name << ' ' << one.name;
    // Where so many seeds tell what is stated from none, it is there; of the cap 400 do.
    if (!one.options.vertical && std::abs(stated) > 4.0 * scatter) {
      EXPECT_GT(std::abs(mean), 3.0 * scatter) << one.of.name << ' ' << one.name;
    }
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

}  // namespace
}  // namespace fettle::engine
