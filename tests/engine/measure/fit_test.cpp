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
#include "tests/engine/measure/seen_shapes.h"

namespace fettle::engine {
namespace {

TEST(Fit, SaysWhatItIsDoing) {
  const Version field = fieldWith({}, [](double x, double y) { return 0.1 * x - 0.2 * y; });
  const FitRegion region = wholeOf(field);
  JobControl job;
  ASSERT_TRUE(fitShape(FitSamples(field, region), ShapeKind::kPlane, {}, job));
  EXPECT_STREQ(job.stage(), "fitting");
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
