// Aligning one field to another: known motions of a known surface.

#include "engine/measure/align.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "engine/compare/compare.h"
#include "engine/field/builder.h"
#include "engine/measure/moved_onto.h"
#include "engine/scanner/scanner.h"
#include "engine/transform/resample.h"
#include "tests/support/coverage.h"

namespace fettle::engine {
namespace {

using tests::countsCoverage;
using tests::Coverage;
using tests::coverageSeeds;
using tests::scatterOfRms;

constexpr double kNoSample = std::numeric_limits<double>::quiet_NaN();

using ShapeOf = std::function<double(double x, double y)>;

// A part with hills of several sizes, everywhere [mm].
double hilly(double x, double y) {
  return 0.4 * std::sin(0.9 * x + 0.3) * std::cos(0.7 * y) + 0.25 * std::sin(1.7 * x - 1.3 * y + 1.0) +
         0.15 * std::cos(2.9 * y + 0.4 * x * x / 10.0) + 0.1 * std::sin(3.1 * x + 0.2 * y * y / 7.0);
}

Grid squareGrid(std::int32_t width, std::int32_t height, double spacing_x, double spacing_y) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = spacing_x;
  grid.spacing_y = spacing_y;
  return grid;
}

// The surface, moved, at the samples of a grid, with noise: reference by bisection, without the product's code.
Version sampledField(const Grid& grid, const ShapeOf& shape, const RigidMotion& motion, double noise,
                     std::uint64_t seed, const std::function<double(int, int, double)>& damage = {}) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<float> heights;
  heights.reserve(static_cast<std::size_t>(grid.samples()));
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      const auto above = [&](double z) {
        const glm::dvec3 p = motion.movedBack({c * grid.spacing_x, r * grid.spacing_y, z});
        return p.z - shape(p.x, p.y);
      };
      double low = -100.0, high = 100.0;
      for (int round = 0; round < 60; ++round) {
        const double middle = 0.5 * (low + high);
        (above(middle) > 0.0 ? high : low) = middle;
      }
      double z = 0.5 * (low + high) + noise * normal(random);
      if (damage) z = damage(c, r, z);
      heights.push_back(static_cast<float>(z));
    }
  return makeField(grid, heights);
}

RigidMotion motionOf(const Grid& grid, const glm::dvec3& shift, const glm::dvec3& turn_deg) {
  const glm::dvec3 middle(0.5 * (grid.width - 1) * grid.spacing_x, 0.5 * (grid.height - 1) * grid.spacing_y,
                          0.0);
  return RigidMotion{glm::dmat3(1.0), glm::dvec3(0.0), middle}.then(shift,
                                                                    turn_deg * (std::numbers::pi / 180.0));
}

// The largest distance between where both motions take the corners and the middle of a field.
double apart(const RigidMotion& a, const RigidMotion& b, const Grid& grid) {
  double most = 0.0;
  const double x = grid.spacing_x * (grid.width - 1), y = grid.spacing_y * (grid.height - 1);
  for (const glm::dvec3& p : {glm::dvec3(0, 0, 0), glm::dvec3(x, 0, 0), glm::dvec3(0, y, 0),
                              glm::dvec3(x, y, 0), glm::dvec3(0.5 * x, 0.5 * y, 0)}) {
    const glm::dvec3 d = a.moved(p) - b.moved(p);
    most = std::max(most, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z));
  }
  return most;
}

TEST(Align, FindsEveryMotionOfAKnownSurface) {
  const Grid a = squareGrid(120, 100, 0.1, 0.1), b = squareGrid(130, 110, 0.1, 0.1);
  for (const auto& [shift, turn] : {std::pair{glm::dvec3(0.0), glm::dvec3(0.0)},
                                    {glm::dvec3(0.537, -0.271, 0.3), glm::dvec3(0.0)},
                                    {glm::dvec3(0.1, 0.2, -3.0), glm::dvec3(2.0, -1.5, 0.0)},
                                    {glm::dvec3(-1.23, 0.77, 0.1), glm::dvec3(0.5, 1.0, 7.3)}}) {
    const RigidMotion truth = motionOf(a, shift, turn);
    const Version first = sampledField(a, hilly, truth, 0.0, 1), second = sampledField(b, hilly, {}, 0.0, 2);
    JobControl job;
    const auto found = alignFields(first, second, {}, job);
    ASSERT_TRUE(found) << found.error().line();
    // Both windows smooth the same shape but for its tilt: a thousandth of the spacing.
    EXPECT_LT(apart(found->motion, truth, b), 2e-4) << turn.z;
    const auto moved = movedOnto(second, found->motion, a, job);
    ASSERT_TRUE(moved);
    const auto deviation = compareFields(first, *moved, job);
    ASSERT_TRUE(deviation);
    // A bilinear patch of 0.1 mm is off by 0.1^2 / 8 times the curvature, at most some 4 / mm here.
    EXPECT_LT(deviation->rms, 4e-3);
    EXPECT_GT(deviation->samples, a.samples() / 2);
  }
}

// Sizes around those at which a resolution comes in, or samples become one height.
TEST(Align, ItsFinestResolutionIsThatWhichIsForeseen) {
  for (const auto& [width, height] :
       {std::pair{40, 30}, {170, 171}, {260, 90}, {600, 540}, {1025, 1023}, {2100, 2060}}) {
    const Grid a = squareGrid(width, height, 0.1, 0.1), b = squareGrid(width - 7, height + 5, 0.1, 0.11);
    const auto field = [](const Grid& grid) {
      std::vector<float> heights;
      for (int r = 0; r < grid.height; ++r)
        for (int c = 0; c < grid.width; ++c) heights.push_back(static_cast<float>(hilly(0.03 * c, 0.03 * r)));
      return makeField(grid, heights);
    };
    std::vector<AlignStage> stages;
    AlignOptions options{.moves = {false, false, false}, .search = false};
    options.stages = &stages;
    JobControl job;
    ASSERT_TRUE(alignFields(field(a), field(b), options, job));
    const FinestAlignment finest = finestAlignment(a, b);
    ASSERT_EQ(static_cast<int>(stages.size()), finest.resolutions) << width;
    for (int k = 0; k < finest.resolutions; ++k)
      EXPECT_EQ(stages[static_cast<std::size_t>(k)].resolution, k) << width;
    EXPECT_EQ(stages.back().places, finest.places) << width;
    // Without those at borders, where the window is not whole: two rows of 30 on each side.
    EXPECT_LE(stages.back().points, finest.points) << width;
    EXPECT_GT(stages.back().points, 7 * finest.points / 10) << width;
    EXPECT_GT(stages.back().refine_seconds, 0.0) << width;
    EXPECT_EQ(finest.resolutions > 1, finest.starts > 0) << width;
  }
}

TEST(Align, FindsShiftsOfMoreThanHalfTheField) {
  const Grid grid = squareGrid(128, 128, 0.1, 0.1);
  for (const glm::dvec3& shift :
       {glm::dvec3(7.0, 0.0, 0.0), glm::dvec3(-6.0, 4.0, 1.0), glm::dvec3(5.5, 5.5, 0.0)}) {
    const RigidMotion truth = motionOf(grid, shift, {0.3, 0.0, -6.0});
    JobControl job;
    const auto found = alignFields(sampledField(grid, hilly, truth, 0.01, 3),
                                   sampledField(grid, hilly, {}, 0.01, 4), {}, job);
    ASSERT_TRUE(found) << found.error().line();
    EXPECT_LT(apart(found->motion, truth, grid), 0.02) << shift.x;
  }
}

TEST(Align, FindsAnyRotationWhereItMaySearchForIt) {
  const Grid grid = squareGrid(110, 110, 0.1, 0.1);
  for (const double degrees : {35.0, -120.0, 180.0}) {
    const RigidMotion truth = motionOf(grid, {0.4, -0.3, 0.0}, {0.0, 0.0, degrees});
    AlignOptions options;
    options.most_rotation_deg = 180.0;
    JobControl job;
    const auto found = alignFields(sampledField(grid, hilly, truth, 0.01, 3),
                                   sampledField(grid, hilly, {}, 0.01, 4), options, job);
    ASSERT_TRUE(found) << found.error().line();
    EXPECT_LT(apart(found->motion, truth, grid), 0.02) << degrees;
    EXPECT_NEAR(std::remainder(found->angles.rotation_z - degrees, 360.0), 0.0, 0.1);
  }
}

TEST(Align, SpikesHolesDustAndUnequalSpacingsDoNotMoveIt) {
  const Grid a = squareGrid(100, 100, 0.12, 0.12), b = squareGrid(330, 90, 0.04, 0.16);
  const RigidMotion truth = motionOf(a, {0.35, -0.22, 0.5}, {0.4, -0.3, 2.0});
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const auto damage = [&](int c, int r, double z) {
    const double u = share(random);
    if (u < 0.05) return kNoSample;
    if (u < 0.06) return 1e6;
    if (u < 0.065) return -1e6;
    return c > 60 && c < 75 && r > 20 && r < 40 ? z + 0.5 : z;  // a block that the other lacks
  };
  JobControl job;
  const auto found = alignFields(sampledField(a, hilly, truth, 0.01, 3, damage),
                                 sampledField(b, hilly, {}, 0.01, 4, damage), {}, job);
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_LT(apart(found->motion, truth, b), 0.01);
  EXPECT_GT(found->left_out, 0.02);
  EXPECT_LT(found->left_out, 0.2);
}

TEST(Align, FewSteepEdgesDecideAPartOfLevelFaces) {
  // Three blocks on a plate with rounded edges, of another rounding in each scan, as two spots of light leave them.
  const auto blocks = [](double round) {
    return [round](double x, double y) {
      const auto step = [round](double u) { return 0.5 * (1.0 + std::tanh(u / round)); };
      const auto block = [&](double x0, double x1, double y0, double y1) {
        return step(x - x0) * step(x1 - x) * step(y - y0) * step(y1 - y);
      };
      return 2.0 * block(2.0, 5.0, 3.0, 9.0) + 1.2 * block(7.0, 11.0, 1.5, 4.0) +
             0.8 * block(8.0, 10.0, 7.0, 10.5);
    };
  };
  const Grid grid = squareGrid(130, 130, 0.1, 0.1);
  const RigidMotion truth = motionOf(grid, {0.43, -0.31, 0.2}, {0.1, 0.0, 1.5});
  JobControl job;
  const auto found = alignFields(sampledField(grid, blocks(0.08), truth, 0.003, 3),
                                 sampledField(grid, blocks(0.25), {}, 0.003, 4), {}, job);
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_LT(apart(found->motion, truth, grid), 0.02);
}

TEST(Align, WallsOnASmoothPartCountAtEveryAngle) {
  // Nearly all places are smooth and agree to a ten thousandth of a millimetre; walls, which decide shift and rotation
  // along the rest, differ by more than that wherever samples are interpolated, and must not be left out for it.
  ScannerSpec spec;
  spec.width = 900;
  spec.height = 700;
  spec.seed = 3;
  JobControl job;
  const auto part = simulateScan(spec, job);
  ASSERT_TRUE(part) << part.error().line();
  const Grid& grid = part->scan.grid();
  for (const double angle : {-6.0, 3.5, 4.0}) {
    ResampleOptions turned;
    turned.angle_deg = angle;
    turned.spacing_x = grid.spacing_x;
    turned.spacing_y = grid.spacing_y;
    const auto second = resampled(part->scan, turned, job);
    ASSERT_TRUE(second) << second.error().line();
    const auto found = alignFields(part->scan, *second, {}, job);
    ASSERT_TRUE(found) << angle << found.error().line();
    // A hundredth of a spacing at the rim: 0.01 x 0.143 mm / 81 mm.
    EXPECT_NEAR(found->angles.rotation_z, -angle, 1e-3);
    EXPECT_LT(found->left_out, 0.05) << angle;
  }
}

TEST(Align, PositionsFarAwayAndOtherUnitsAreTheSame) {
  Grid a = squareGrid(100, 100, 0.1, 0.1), b = a;
  const RigidMotion truth = motionOf(a, {0.3, 0.1, 0.0}, {0.0, 0.2, 1.0});
  const Version first = sampledField(a, hilly, truth, 0.005, 3),
                second = sampledField(b, hilly, {}, 0.005, 4);
  JobControl job;
  const auto plain = alignFields(first, second, {}, job);
  ASSERT_TRUE(plain);
  a.origin_x = b.origin_x = 5e6;
  a.origin_y = b.origin_y = 5e6;
  const RigidMotion still = motionOf(a, glm::dvec3(0.0), glm::dvec3(0.0));
  const auto far_away =
      alignFields(sampledField(a, hilly, truth, 0.005, 3), sampledField(b, hilly, {}, 0.005, 4), {}, job);
  ASSERT_TRUE(far_away);
  EXPECT_LT(apart(plain->motion, far_away->motion, a), 1e-9);
  EXPECT_GT(apart(plain->motion, still, a), 0.3);
  // The second in micrometres, moved onto the first in millimetres.
  Grid um = squareGrid(100, 100, 100.0, 100.0);
  um.lateral_unit = um.height_unit = {"um", 1e-3};
  std::vector<float> heights;
  for (int r = 0; r < 100; ++r)
    for (int c = 0; c < 100; ++c) heights.push_back(second.reader().heightAt(c, r) * 1000.0F);
  const Version in_um = makeField(um, heights);
  const auto other = alignFields(first, in_um, {}, job);
  ASSERT_TRUE(other);
  EXPECT_LT(apart(plain->motion, other->motion, a), 1e-5);
  const auto moved = movedOnto(in_um, other->motion, first.grid(), job);
  ASSERT_TRUE(moved);
  EXPECT_LT(compareFields(first, *moved, job)->rms, 0.02);
}

// Positions by which both fields would lie side by side are those of other coordinates: both begin at one corner.
TEST(Align, PositionsThatPutFieldsApartDoNotCount) {
  const Grid a = squareGrid(100, 100, 0.1, 0.1);
  const RigidMotion truth = motionOf(a, {0.2, -0.1, 0.0}, {0.0, 0.2, 1.0});
  const Version first = sampledField(a, hilly, truth, 0.005, 3);
  AlignOptions options;
  options.search = false;
  JobControl job;
  for (const auto& [x, y] : {std::pair{1000.0, 0.0}, {-1000.0, 0.0}, {0.0, 1000.0}, {0.0, -1000.0}}) {
    Grid b = a;
    b.origin_x = x;
    b.origin_y = y;
    const auto found = alignFields(first, sampledField(b, hilly, {}, 0.005, 4), options, job);
    ASSERT_TRUE(found) << x << ' ' << y << found.error().line();
    EXPECT_LT(apart(found->motion, truth, a), 0.01) << x << ' ' << y;
  }
  // Where they overlap they do: a part that began 4 mm farther on is found there, and nowhere without.
  Grid b = squareGrid(100, 100, 0.1, 0.1);
  const auto farther_on = [](double x, double y) { return hilly(x + 4.0, y + 3.0); };
  RigidMotion there = truth;
  b.origin_x = 4.0;
  b.origin_y = 3.0;
  const auto found = alignFields(sampledField(a, hilly, {}, 0.005, 3),
                                 sampledField(b, farther_on, {}, 0.005, 4), options, job);
  ASSERT_TRUE(found) << found.error().line();
  there = RigidMotion{glm::dmat3(1.0), {4.0, 3.0, 0.0}, truth.centre};
  EXPECT_LT(apart(found->motion, there, a), 0.01);
}

TEST(Align, WhatTheSurfaceDoesNotDecideIsNamed) {
  const Grid grid = squareGrid(96, 96, 0.1, 0.1);
  struct Case {
    const char* name;
    ShapeOf shape;
    AlignMoves moves;
    bool decided;
    const char* text;
  };
  const ShapeOf plane = [](double x, double y) { return 0.1 * x - 0.05 * y; };
  const ShapeOf cylinder = [](double x, double) { return std::sqrt(144.0 - (x - 4.0) * (x - 4.0)) - 12.0; };
  const ShapeOf sphere = [](double x, double y) {
    return std::sqrt(225.0 - (x - 4.0) * (x - 4.0) - (y - 5.0) * (y - 5.0)) - 15.0;
  };
  const ShapeOf cone = [](double x, double y) { return -0.3 * std::hypot(x - 4.7, y - 4.8); };
  for (const Case& one : {Case{"plane", plane, {}, false, "shift"},
                          {"plane", plane, {false, false, true}, true, ""},
                          {"cylinder", cylinder, {}, false, "along y"},
                          {"cylinder", cylinder, {true, false, false}, false, "along y"},
                          {"sphere", sphere, {}, false, ""},
                          {"sphere", sphere, {true, true, false}, false, "rotation"},
                          {"sphere", sphere, {true, false, false}, true, ""},
                          {"cone", cone, {}, false, "rotation"},
                          {"cone", cone, {true, false, true}, true, ""},
                          {"hilly", hilly, {}, true, ""}})
    for (const double noise : {0.0, 0.003}) {
      JobControl job;
      AlignOptions options;
      options.moves = one.moves;
      const auto found = alignFields(sampledField(grid, one.shape, {}, noise, 3),
                                     sampledField(grid, one.shape, {}, noise, 4), options, job);
      EXPECT_EQ(found.has_value(), one.decided)
          << one.name << one.moves.shift << one.moves.rotation << one.moves.tilt << ' ' << noise << ' '
          << (found ? "" : found.error().line());
      if (!found && !one.decided) {
        EXPECT_NE(found.error().what.find(one.text), std::string::npos)
            << one.name << ' ' << found.error().what;
      }
    }
}

TEST(Align, EachOpenMotionIsNamedOnce) {
  JobControl job;
  const Version flat = sampledField(
      squareGrid(40, 40, 1.0, 1.0), [](double, double) { return 1.5; }, {}, 0.0, 1);
  const auto found = alignFields(flat, flat, {}, job);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().what,
            "the surface does not decide a shift along x, a shift along y and the rotation about z");
  // Noise alone mixes the three.
  const Version noisy = sampledField(
      squareGrid(60, 60, 1.0, 1.0), [](double, double) { return 0.0; }, {}, 0.1, 1);
  const Version other = sampledField(
      squareGrid(60, 60, 1.0, 1.0), [](double, double) { return 0.0; }, {}, 0.1, 2);
  const auto mixed = alignFields(noisy, other, {}, job);
  ASSERT_FALSE(mixed);
  const std::string& what = mixed.error().what;
  EXPECT_EQ(what.find("shift along x"), what.rfind("shift along x")) << what;
}

TEST(Align, OneRowIsTooFewAndSaysWhy) {
  JobControl job;
  const Version row = sampledField(
      squareGrid(40, 1, 1.0, 1.0), [](double x, double) { return 0.1 * x * x; }, {}, 0.0, 1);
  const auto found = alignFields(row, row, {}, job);
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().what.find("0 heights of A are whole after a Gaussian window of 1.25 mm"),
            std::string::npos)
      << found.error().line();
}

TEST(Align, AnotherPartIsRefused) {
  const Grid grid = squareGrid(96, 96, 0.1, 0.1);
  const ShapeOf other = [](double x, double y) {
    return hilly(1.7 * y + 30.0, 1.3 * x - 50.0) + 0.3 * std::sin(2.2 * x);
  };
  JobControl job;
  const auto found =
      alignFields(sampledField(grid, hilly, {}, 0.01, 3), sampledField(grid, other, {}, 0.01, 4), {}, job);
  EXPECT_FALSE(found) << found->rms_mm;
}

TEST(Align, FieldsWithoutHeightsAndOfOneRowAreRefused) {
  JobControl job;
  const Grid grid = squareGrid(40, 40, 0.1, 0.1), row = squareGrid(400, 1, 0.1, 0.1);
  const Version some = sampledField(grid, hilly, {}, 0.0, 1);
  const Version none = sampledField(grid, hilly, {}, 0.0, 1, [](int, int, double) { return kNoSample; });
  EXPECT_FALSE(alignFields(some, none, {}, job));
  EXPECT_FALSE(alignFields(none, some, {}, job));
  EXPECT_FALSE(alignFields(sampledField(row, hilly, {}, 0.0, 1), some, {}, job));
  EXPECT_FALSE(alignFields(some, sampledField(row, hilly, {}, 0.0, 1), {}, job));
  AlignOptions marked;
  marked.region = Region::kMarked;
  EXPECT_FALSE(alignFields(some, some, marked, job));
}

TEST(Align, ThreadsDoNotChangeABit) {
  const Grid grid = squareGrid(150, 140, 0.1, 0.1);
  const RigidMotion truth = motionOf(grid, {0.3, 0.1, 0.0}, {0.3, 0.2, 1.0});
  const Version first = sampledField(grid, hilly, truth, 0.005, 3),
                second = sampledField(grid, hilly, {}, 0.005, 4);
  const auto run = [&](int threads) {
    tbb::task_arena arena(threads);
    JobControl job;
    return arena.execute([&] { return alignFields(first, second, {}, job); });
  };
  const auto one = run(1), four = run(4);
  ASSERT_TRUE(one && four);
  EXPECT_EQ(one->motion.matrix(), four->motion.matrix());
  EXPECT_EQ(one->covariance, four->covariance);
}

TEST(Align, ACancelledJobSaysSo) {
  const Grid grid = squareGrid(64, 64, 0.1, 0.1);
  JobControl job;
  job.cancel();
  const Version field = sampledField(grid, hilly, {}, 0.0, 1);
  const auto found = alignFields(field, field, {}, job);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().kind, ErrorKind::kCancelled);
  EXPECT_FALSE(movedOnto(field, {}, grid, job));
}

// The stated error of files that agree to the last bit is that of rounding to float, which is uniform: of variance 1/12. Known
// noise gives the ratio of the height's error to that of one place.
TEST(AlignUncertainty, OfTwoAlikeFilesIsThatOfHeightsRoundedToFloat) {
  const Grid grid = squareGrid(96, 96, 0.1, 0.1);
  const ShapeOf high_up = [](double x, double y) { return 50.0 + 0.1 * hilly(x, y); };
  const AlignOptions options{.moves = {false, false, false}, .search = false};
  const Version one = sampledField(grid, high_up, {}, 0.0, 1);
  JobControl job;
  const auto alike = alignFields(one, one, options, job),
             noisy = alignFields(one, sampledField(grid, high_up, {}, 0.01, 4), options, job);
  ASSERT_TRUE(alike) << alike.error().line();
  ASSERT_TRUE(noisy) << noisy.error().line();
  const double rounding = 50.0 * std::numeric_limits<float>::epsilon() / std::sqrt(12.0);
  // Tukey's weights, of noise alone, cost 2.5 % of the error; 9,000 places give the noise's size within 2 %.
  EXPECT_NEAR(alike->shift_error.z / rounding / (noisy->shift_error.z / noisy->rms_mm), 0.975, 0.05);
}

TEST(MovedOnto, ThroughNoMotionEveryBitStays) {
  const Grid grid = squareGrid(70, 66, 0.1, 0.3);
  const Version field =
      sampledField(grid, hilly, {}, 0.1, 1, [](int c, int r, double z) { return c == r ? kNoSample : z; });
  JobControl job;
  const auto moved = movedOnto(field, {}, grid, job);
  ASSERT_TRUE(moved);
  EXPECT_STREQ(job.stage(), "moving the field");
  EXPECT_EQ(job.total(), 4U);
  EXPECT_EQ(job.done(), job.total());
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      const float was = field.reader().heightAt(c, r), is = moved->reader().heightAt(c, r);
      EXPECT_TRUE(was == is || (std::isnan(was) && std::isnan(is))) << c << ' ' << r;
    }
}

// Through no motion a sample on the upper or right border is that sample, whatever lies beside it.
TEST(MovedOnto, BordersBesideHolesStay) {
  const Grid grid = squareGrid(70, 66, 0.1, 0.3);
  const Version field = sampledField(grid, hilly, {}, 0.1, 1, [](int c, int r, double z) {
    return (r == 64 && c < 40) || (c == 68 && r < 30) ? kNoSample : z;
  });
  JobControl job;
  const auto moved = movedOnto(field, {}, grid, job);
  ASSERT_TRUE(moved);
  for (int c = 0; c < 70; ++c)
    EXPECT_EQ(moved->reader().heightAt(c, 65), field.reader().heightAt(c, 65)) << c;
  for (int r = 0; r < 66; ++r)
    EXPECT_EQ(moved->reader().heightAt(69, r), field.reader().heightAt(69, r)) << r;
  EXPECT_EQ(summarize(*moved).no_data, summarize(field).no_data);
  // Half way between samples of a border too.
  const auto along = movedOnto(field, {.shift = {0.05, 0.0, 0.0}}, grid, job),
             across = movedOnto(field, {.shift = {0.0, 0.15, 0.0}}, grid, job);
  ASSERT_TRUE(along && across);
  const FieldReader z = field.reader();
  for (int c = 1; c < 70; ++c)
    EXPECT_NEAR(along->reader().heightAt(c, 65), 0.5 * (z.heightAt(c - 1, 65) + z.heightAt(c, 65)), 1e-6)
        << c;
  for (int r = 1; r < 66; ++r)
    EXPECT_NEAR(across->reader().heightAt(69, r), 0.5 * (z.heightAt(69, r - 1) + z.heightAt(69, r)), 1e-6)
        << r;
}

// The table is printed: build/release/tests/engine/measure/measure_test --gtest_filter='AlignUncertainty*'
TEST(AlignUncertainty, CoversAtOneTwoAndThreeTimes) {
  struct Case {
    const char* name;
    Grid a, b;
    double noise;
    bool correlated;
  };
  const Grid small = squareGrid(64, 64, 0.1, 0.1);
  const char* const kNames[] = {"shift x", "shift y", "height", "tilt x", "tilt y", "rotation"};
  std::printf("%-12s %-10s %-22s %11s %11s\n", "", "", "within 1, 2, 3", "error", "stated");
  for (const Case& one :
       {Case{"alike", small, small, 0.01, false},
        {"1:4", small, squareGrid(150, 45, 0.045, 0.15), 0.02, false},
        {"shared", squareGrid(100, 100, 0.1, 0.1), squareGrid(100, 100, 0.1, 0.1), 0.01, true}}) {
    const RigidMotion truth = motionOf(one.a, {0.123, -0.071, 0.2}, {0.3, -0.2, 0.7});
    const Version clean_a = sampledField(one.a, hilly, truth, 0.0, 1),
                  clean_b = sampledField(one.b, hilly, {}, 0.0, 1);
    const auto noisy = [&](const Version& clean, std::uint64_t seed) {
      const Grid& grid = clean.grid();
      std::mt19937_64 random(seed);
      std::normal_distribution<double> normal(0.0, one.noise);
      std::vector<float> heights;
      heights.reserve(static_cast<std::size_t>(grid.samples()));
      for (int r = 0; r < grid.height; ++r)
        for (int c = 0; c < grid.width; ++c) heights.push_back(static_cast<float>(normal(random)));
      // Noise of 3 x 3 neighbours, each with its share.
      std::vector<float> shared = heights;
      if (one.correlated)
        for (int r = 1; r + 1 < grid.height; ++r)
          for (int c = 1; c + 1 < grid.width; ++c) {
            float sum = 0.0F;
            for (int j = -1; j <= 1; ++j)
              for (int i = -1; i <= 1; ++i)
                sum += heights[static_cast<std::size_t>((r + j) * grid.width + c + i)];
            shared[static_cast<std::size_t>(r * grid.width + c)] = sum / 3.0F;
          }
      for (int r = 0; r < grid.height; ++r)
        for (int c = 0; c < grid.width; ++c)
          shared[static_cast<std::size_t>(r * grid.width + c)] += clean.reader().heightAt(c, r);
      return makeField(grid, shared);
    };
    std::array<Coverage, 6> covered;
    for (int seed = 0; seed < coverageSeeds(); ++seed) {
      AlignOptions options;
      options.search = false;
      JobControl job;
      const auto found = alignFields(noisy(clean_a, 2 * static_cast<std::uint64_t>(seed) + 10),
                                     noisy(clean_b, 2 * static_cast<std::uint64_t>(seed) + 11), options, job);
      ASSERT_TRUE(found) << seed << found.error().line();
      // The same motion about the truth's centre.
      const glm::dvec3 shift = found->motion.moved(truth.centre) - truth.centre;
      const RigidMotion::Angles t = truth.angles();
      const double errors[6] = {shift.x - truth.shift.x,         shift.y - truth.shift.y,
                                shift.z - truth.shift.z,         found->angles.tilt_x - t.tilt_x,
                                found->angles.tilt_y - t.tilt_y, found->angles.rotation_z - t.rotation_z};
      const double says[6] = {found->shift_error.x,      found->shift_error.y,
                              found->shift_error.z,      found->angle_error.tilt_x,
                              found->angle_error.tilt_y, found->angle_error.rotation_z};
      for (std::size_t k = 0; k < 6; ++k) covered[k].add(errors[k], says[k]);
    }
    for (std::size_t k = 0; k < 6; ++k) {
      const Coverage& of = covered[k];
      std::printf("%-12s %-10s %s %11.3e %11.3e\n", one.name, kNames[k], of.counts().c_str(), of.rms(),
                  of.stated());
      if (!countsCoverage()) continue;
      if (one.correlated) {
        // What borders of blocks cut off, and less than a seventh of 1,000.
        EXPECT_NEAR(of.stated() / of.rms(), 1.0, 0.075 + scatterOfRms()) << one.name << kNames[k];
        continue;
      }
      EXPECT_EQ(of.complaint(), "") << one.name << kNames[k];
    }
  }
}

}  // namespace
}  // namespace fettle::engine
