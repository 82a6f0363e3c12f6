#include "engine/edges/edge_profile.h"

#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/edges/locate.h"
#include "engine/field/builder.h"
#include "engine/scanner/scanner.h"
#include "engine/scanner/true_lines.h"
#include "tests/engine/filter/edge_line_of.h"

namespace fettle::engine {
namespace {

using tests::edgeLineOf;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

struct TwoPlanes {
  int columns = 60, rows = 50;
  double sx = 0.05, sy = 0.05;
  double step = 0.1;  // left surface less right one [mm]
  double left = 0.0,
         right = 0.0;  // inclinations across a line along y, going up: left is towards smaller x [degrees]
  double level = 0.0;
};

template <class Height>
Version sampledField(const Grid& grid, Height&& height) {
  auto builder = FieldBuilder::create(grid, "test");
  EXPECT_TRUE(builder);
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      const auto z = static_cast<float>(height(c, r));
      builder->writeHeights(c, r, 1, 1, &z, 1);
    }
  return std::move(*builder).build();
}

// A line up the column 29.4, with the left surface at smaller x.
Version twoPlaneField(const TwoPlanes& shape, double noise, std::uint64_t seed) {
  Grid grid;
  grid.width = shape.columns;
  grid.height = shape.rows;
  grid.spacing_x = shape.sx;
  grid.spacing_y = shape.sy;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> white(0.0, noise > 0.0 ? noise : 1.0);
  return sampledField(grid, [&](int c, int) {
    const double across = (29.4 - c) * shape.sx;  // towards the left
    const double slope = std::tan((across > 0 ? shape.left : shape.right) * kDegree);
    const double z = shape.level + slope * across + (across > 0 ? shape.step : 0.0);
    return z + (noise > 0.0 ? white(random) : 0.0);
  });
}

MeasuredEdge edgeOf(const Version& field, const EdgeNoise& noise, const EdgeLine& line) {
  JobControl job;
  auto edges = measureEdges(field, noise, {line}, job);
  EXPECT_TRUE(edges);
  return edges ? std::move(edges->front()) : MeasuredEdge{};
}

std::vector<EdgeSection> measured(const Version& field, double noise, const EdgeLine& line) {
  return edgeOf(field, {.sigma = noise}, line).sections;
}

TEST(EdgeProfile, IsExactOnTwoPlanes) {
  for (const TwoPlanes& shape :
       {TwoPlanes{}, TwoPlanes{60, 50, 0.05, 0.05, -0.2, 30.0, -12.0},
        TwoPlanes{60, 50, 0.1, 0.025, 0.0, 20.0, 0.0}, TwoPlanes{60, 50, 0.02, 0.2, 1e-3, -5.0, 40.0},
        TwoPlanes{60, 50, 0.05, 0.05, 0.1, 1.0, 0.0, 1e4}}) {
    const Version field = twoPlaneField(shape, 0.0, 1);
    // Slopes are fitted 1.2e-4 too small (kLevelling).
    const double level = 1e-6 * (std::abs(shape.level) + 1.0),
                 slopes = std::abs(shape.left) + std::abs(shape.right);
    const double of_step = level + 3e-4 * kDegree * slopes * shape.sx,
                 of_turn = level / (kDegree * shape.sx) + 2e-4 * slopes;
    for (const EdgeSection& s : measured(field, 1e-4, edgeLineOf({{29.4, 5.0}, {29.4, 44.0}}))) {
      ASSERT_TRUE(s.measured);
      EXPECT_NEAR(s.step, shape.step, of_step);
      EXPECT_NEAR(s.turn, shape.left - shape.right, of_turn);
    }
    // The other way along, left is right.
    const auto back = measured(field, 1e-4, edgeLineOf({{29.4, 44.0}, {29.4, 5.0}}));
    EXPECT_NEAR(back[20].step, -shape.step, of_step);
    EXPECT_NEAR(back[20].turn, shape.left - shape.right, of_turn);
    EXPECT_NEAR(back.back().along_mm, 39.0 * shape.sy, 0.6 * shape.sy);
  }
}

// The stated deviations assume some noise that neighbours share: of white noise 1.14 times too large.
TEST(EdgeProfile, StatedDeviationsCoverTheErrors) {
  const TwoPlanes shape{60, 50, 0.05, 0.05, 0.05, 8.0, -3.0};
  constexpr double kNoise = 0.02;
  constexpr int kRuns = 1000;
  int step_within[3] = {}, turn_within[3] = {}, mean_within[3] = {};
  for (int run = 0; run < kRuns; ++run) {
    const Version field = twoPlaneField(shape, kNoise, 100 + run);
    const auto [sections, means] = edgeOf(field, {.sigma = kNoise}, edgeLineOf({{29.4, 5.0}, {29.4, 44.0}}));
    const EdgeSection& s = sections[40];
    ASSERT_TRUE(s.measured);
    for (int k = 0; k < 3; ++k) {
      step_within[k] += std::abs(s.step - shape.step) <= (k + 1) * s.step_deviation;
      turn_within[k] += std::abs(s.turn - (shape.left - shape.right)) <= (k + 1) * s.turn_deviation;
      mean_within[k] += std::abs(means.step - shape.step) <= (k + 1) * means.step_deviation;
    }
  }
  for (const auto* within : {step_within, turn_within, mean_within}) {
    EXPECT_GT(within[0], 683 - 45);
    EXPECT_LT(within[0], 820);
    EXPECT_GT(within[1], 954 - 20);
    EXPECT_GE(within[2], 991);
  }
}

// What whole rows are off together does not average away along a row: the mean over 200 samples is hardly more certain
// than one section of it. Across rows both sides of the line share it, so that the step has none.
TEST(EdgeProfile, StatedDeviationsKnowWhatRowsAndColumnsAreOff) {
  constexpr double kNoise = 0.01, kOffset = 0.006, kStep = 0.2;
  constexpr int kRuns = 400;
  Grid grid;
  grid.width = 200, grid.height = 60;
  grid.spacing_x = grid.spacing_y = 0.05;
  const EdgeLine along = edgeLineOf({{5.0, 29.4}, {194.0, 29.4}});
  int step_within[3] = {}, turn_within[3] = {};
  for (int run = 0; run < kRuns; ++run) {
    std::mt19937_64 random(900 + run);
    std::normal_distribution<double> white(0.0, kNoise), shared(0.0, kOffset);
    std::vector<double> offset(static_cast<std::size_t>(grid.height));
    for (double& row : offset) row = shared(random);
    const Version field = sampledField(grid, [&](int, int r) {
      return (r > 29 ? kStep : 0.0) + offset[static_cast<std::size_t>(r)] + white(random);
    });
    const EdgeMeans means = edgeOf(field, {.sigma = kNoise, .rows = kOffset}, along).means;
    ASSERT_GT(means.measured, 180);
    for (int k = 0; k < 3; ++k) {
      step_within[k] += std::abs(means.step - kStep) <= (k + 1) * means.step_deviation;
      turn_within[k] += std::abs(means.turn) <= (k + 1) * means.turn_deviation;
    }
  }
  // Shares of a normal distribution, less three standard errors of 400 runs; more where white noise is stated 1.14 times
  // too large.
  for (const int* within : {step_within, turn_within}) {
    EXPECT_GT(within[0], 273 - 28);
    EXPECT_LT(within[0], 330);
    EXPECT_GT(within[1], 382 - 13);
    EXPECT_GE(within[2], 395);
  }

  // How much of an offset enters, without a seed.
  const Version plain = sampledField(grid, [&](int, int r) { return r > 29 ? kStep : 0.0; });
  const EdgeMeans without = edgeOf(plain, {.sigma = kNoise}, along).means;
  const EdgeMeans rows = edgeOf(plain, {.sigma = kNoise, .rows = kOffset}, along).means;
  const EdgeMeans columns = edgeOf(plain, {.sigma = kNoise, .columns = kOffset}, along).means;
  // On the left rows 31 to 38 count, 1.6 to 8.6 samples from the line, on the right 28 to 20, 1.4 to 9.4: a straight line
  // through them has at the line a variance of 1 / n + mean^2 / sum of squares about the mean.
  const double left = 1.0 / 8.0 + 5.1 * 5.1 / 42.0, right = 1.0 / 9.0 + 5.4 * 5.4 / 60.0;
  EXPECT_NEAR(std::sqrt(std::pow(rows.step_deviation, 2) - std::pow(without.step_deviation, 2)),
              kOffset * std::sqrt(left + right), 1e-3 * kOffset);
  EXPECT_NEAR(columns.step_deviation, without.step_deviation, 1e-3 * kOffset);
}

// The lines of a part, with noise of a scanner: the mean over each line next to the true step.
TEST(EdgeProfile, FindsTheStepsOfAPart) {
  JobControl job;
  ScannerSpec spec;
  spec.part = "steps";
  spec.width = spec.height = 512;
  int lines = 0, within = 0;
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    spec.seed = seed;
    const auto scan = simulateScan(spec, job);
    ASSERT_TRUE(scan);
    const std::vector<EdgeLine> truth = trueLines(*scan);
    const auto sections = measureEdges(scan->scan, {.sigma = scan->sigma_mm}, truth, job);
    const auto exact = measureEdges(scan->truth, {.sigma = scan->sigma_mm}, truth, job);
    ASSERT_TRUE(sections && exact);
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const EdgeMeans of_scan = (*sections)[k].means, of_truth = (*exact)[k].means;
      if (of_scan.measured < 50) continue;
      ++lines;
      within += std::abs(of_scan.step - of_truth.step) <= 3.0 * of_scan.step_deviation;
      EXPECT_NEAR(of_scan.step, of_truth.step, 0.1 * std::abs(of_truth.step) + 5.0 * of_scan.step_deviation);
    }
  }
  EXPECT_GT(lines, 10);
  EXPECT_GE(within, 0.9 * lines) << lines;
}

TEST(EdgeProfile, NextToAnotherLineOnlyTheSurfaceBetweenCounts) {
  // A rib 8 samples wide on a plate.
  Grid grid;
  grid.width = 60, grid.height = 50;
  grid.spacing_x = grid.spacing_y = 0.05;
  const Version field = sampledField(grid, [](int c, int) { return c >= 25 && c < 33 ? 0.5 : 0.0; });
  JobControl job;
  const auto both =
      measureEdges(field, {.sigma = 1e-3},
                   {edgeLineOf({{24.5, 2.0}, {24.5, 47.0}}), edgeLineOf({{32.5, 2.0}, {32.5, 47.0}})}, job);
  ASSERT_TRUE(both);
  EXPECT_NEAR((*both)[0].means.step, -0.5, 1e-6);
  EXPECT_NEAR((*both)[1].means.step, 0.5, 1e-6);
}

// What a filter leaves has next to no noise, and its slopes lie at any angle to the grid.
TEST(EdgeProfile, MeasuresSteepSurfacesWithoutNoiseAtAnyAngle) {
  Grid grid;
  grid.width = grid.height = 120;
  grid.spacing_x = grid.spacing_y = 0.2;
  for (const double angle : {0.0, 30.0, 45.0, 77.0}) {
    const glm::dvec2 along{std::cos(angle * kDegree), std::sin(angle * kDegree)}, left{-along.y, along.x};
    const glm::dvec2 middle{60.3, 59.6};
    const double slope = std::tan(40.0 * kDegree);
    // A roof with a mixed pixel here and there.
    std::mt19937 random(9);
    const Version field = sampledField(grid, [&](int c, int r) {
      const double across = glm::dot(glm::dvec2(c, r) - middle, left) * 0.2;
      return -slope * std::abs(across) + (random() % 97 == 0 ? 3.0 : 0.0);
    });
    for (const double noise : {0.0, 2e-3}) {
      const EdgeMeans means =
          edgeOf(field, {.sigma = noise}, edgeLineOf({middle - 40.0 * along, middle + 40.0 * along})).means;
      EXPECT_GT(means.measured, 140) << angle;
      EXPECT_NEAR(means.turn, -80.0, 0.1) << angle;
      EXPECT_NEAR(means.step, 0.0, 0.002) << angle;
    }
  }
}

TEST(EdgeProfile, HardFieldsGiveAFigureOrNone) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const glm::ivec2 size : {glm::ivec2(60, 1), {1, 50}, {2, 2}, {60, 50}})
    for (const float value : {0.0F, 1e-42F, 1e6F, nan}) {
      Grid grid;
      grid.width = size.x, grid.height = size.y;
      std::mt19937 random(5);
      const Version field = sampledField(grid, [&](int, int) { return random() % 7 == 0 ? value : 0.25F; });
      EdgeLine plain = edgeLineOf({{3.0, -20.0}, {40.0, 80.0}});
      for (EdgePoint& point : plain.points) point.located = false;
      JobControl job;
      const auto all =
          measureEdges(field, {.sigma = 0.01},
                       {edgeLineOf({{29.4, 5.0}, {29.4, 44.0}}), edgeLineOf({{-500.0, 3.0}, {-480.0, 3.0}}),
                        edgeLineOf({{5.0, 0.0}, {6.0, 0.0}}), plain, EdgeLine{}},
                       job);
      ASSERT_TRUE(all);
      for (const MeasuredEdge& edge : *all)
        for (const EdgeSection& s : edge.sections) {
          EXPECT_TRUE(std::isfinite(s.step) && std::isfinite(s.step_deviation) && std::isfinite(s.turn) &&
                      std::isfinite(s.turn_deviation) && std::isfinite(s.along_mm));
          if (!s.measured) {
            EXPECT_EQ(s.step_deviation, 0.0);
          }
        }
      EXPECT_EQ((*all)[1].means.measured, 0);
      EXPECT_EQ((*all)[3].means.measured, 0);
      EXPECT_EQ((*all)[4].means.measured, 0);
    }
  JobControl job;
  EXPECT_FALSE(measureEdges(twoPlaneField({}, 0.0, 1), {.sigma = std::nan("")}, {}, job));
  job.cancel();
  EXPECT_FALSE(measureEdges(twoPlaneField({}, 0.0, 1), {.sigma = 0.01},
                            {edgeLineOf({{29.4, 5.0}, {29.4, 44.0}})}, job));
}

}  // namespace
}  // namespace fettle::engine
