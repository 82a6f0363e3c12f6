// Aligning a nominal to a part that was made of it, moved.

#include "engine/nominal/nominal_align.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>
#include <glm/geometric.hpp>

#include "engine/field/builder.h"
#include "engine/nominal/nominal_surface.h"
#include "tests/engine/nominal/meshes.h"

namespace fettle::engine {
namespace {

// A plate of 14 x 12 mm with domes of its own each.
double plate(double x, double y) {
  double z = 0.05 * x;
  for (const auto& [cx, cy, r, h] : {std::array{3.0, 3.0, 1.2, 0.8},
                                     {9.5, 3.5, 2.0, 0.5},
                                     {5.0, 8.5, 1.6, 0.9},
                                     {11.0, 9.0, 1.0, 0.6},
                                     {7.2, 6.0, 0.7, -0.4}}) {
    const double square = ((x - cx) * (x - cx) + (y - cy) * (y - cy)) / (r * r);
    z += h * std::exp(-square);
  }
  return z;
}

Grid scanGrid(double sx, double sy) {
  Grid grid;
  grid.width = static_cast<std::int32_t>(12.0 / sx) + 1;
  grid.height = static_cast<std::int32_t>(10.0 / sy) + 1;
  grid.spacing_x = sx;
  grid.spacing_y = sy;
  return grid;
}

RigidMotion motionBy(const glm::dvec3& shift, const glm::dvec3& turn_deg, double centre_z = 0.0) {
  return RigidMotion{glm::dmat3(1.0), glm::dvec3(0.0), {6.0, 5.0, centre_z}}.then(
      shift, turn_deg * (std::numbers::pi / 180.0));
}

// A scan of the mesh in a place, with noise and damage.
Version scanOf(const NominalMesh& mesh, const RigidMotion& motion, const Grid& grid, double noise,
               std::uint64_t seed, bool damaged = false) {
  const NominalSurface surface(mesh, motion, 0.0);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, noise > 0.0 ? noise : 1.0);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<float> heights;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      double z = surface.topAt(c * grid.spacingXMm(), r * grid.spacingYMm()).z +
                 (noise > 0.0 ? normal(random) : 0.0);
      if (damaged) {
        const double what = share(random);
        if (what < 0.01)
          z = std::numeric_limits<double>::quiet_NaN();
        else if (what < 0.02)
          z = 1e6;
        else if (c > grid.width * 3 / 4 && r > grid.height * 3 / 4)
          z += 0.3;  // worn, or made wrong
      }
      heights.push_back(static_cast<float>(z / grid.height_unit.mm));
    }
  return makeField(grid, heights);
}

// How far apart two motions take the corners and the middle of the plate, at most.
double placesApart(const RigidMotion& a, const RigidMotion& b) {
  double most = 0.0;
  for (const glm::dvec3& p : {glm::dvec3(1, 1, 0), glm::dvec3(13, 1, 0), glm::dvec3(1, 11, 0),
                              glm::dvec3(13, 11, 0), glm::dvec3(7, 6, 0)})
    most = std::max(most, glm::length(a.moved(p) - b.moved(p)));
  return most;
}

NominalMesh plateMesh(double x0 = 0.0, double y0 = 0.0, double z0 = 0.0) {
  return meshOf(surfaceOver(
      14, 12, 280, 240, [z0](double x, double y) { return plate(x, y) + z0; }, x0, y0));
}

TEST(NominalAlign, FindsKnownMotionsWithoutTheRasterOfTheMesh) {
  const NominalMesh mesh = plateMesh();
  for (const auto& [shift, turn] : {std::pair{glm::dvec3(-1.0, -1.0, 0.0), glm::dvec3(0.0)},
                                    {glm::dvec3(-0.413, -1.271, 0.3), glm::dvec3(1.0, -2.0, 4.3)},
                                    {glm::dvec3(-1.5, -0.7, -20.0), glm::dvec3(0.0, 3.0, -8.0)}})
    for (const double sy : {0.1, 0.05}) {
      const RigidMotion truth = motionBy(shift, turn);
      const Grid grid = scanGrid(0.1, sy);
      JobControl job;
      const auto found = alignNominal(scanOf(mesh, truth, grid, 0.0, 1), mesh, {}, job);
      ASSERT_TRUE(found) << found.error().line();
      // What is left is the rounding of heights to float: 1e-6 mm at 20.
      EXPECT_LT(placesApart(found->motion, truth), 1e-5) << shift.x << ' ' << sy;
      EXPECT_EQ(found->motion.centre.x, 0.5 * 0.1 * (grid.width - 1));
    }
}

TEST(NominalAlign, StandsDamageAndAFarOriginAndStatesItsErrors) {
  // Far away in all three; heights in um; 2 % damaged, a quarter of a quarter made wrong.
  const NominalMesh mesh = plateMesh(5e6, -5e6, 400.0);
  Grid grid = scanGrid(0.1, 0.1);
  grid.height_unit = {"um", 1e-3};
  const RigidMotion truth = motionBy({-0.6, -1.2, -399.0}, {0.5, -0.7, 3.0}, 400.0);
  double squares = 0.0, worst = 0.0;
  int within = 0;
  constexpr int kSeeds = 8;
  for (int seed = 0; seed < kSeeds; ++seed) {
    JobControl job;
    const auto found =
        alignNominal(scanOf(mesh, truth, grid, 0.01, static_cast<std::uint64_t>(seed), true), mesh, {}, job);
    ASSERT_TRUE(found) << found.error().line();
    // How far the nominal's middle is from the truth, beside the stated error of a shift along x.
    const glm::dvec3 middle(7.0, 6.0, 400.0), off = found->motion.moved(middle) - truth.moved(middle);
    const double error = std::sqrt(found->covariance[0]);
    squares += off.x * off.x / (error * error);
    within += std::abs(off.x) < 2.0 * error ? 1 : 0;
    worst = std::max(worst, glm::length(off));
  }
  std::printf("8 seeds: %d within two standard errors, rms %.2f of them, the middle off by at most %.2g mm\n",
              within, std::sqrt(squares / kSeeds), worst);
  // chi^2 of 8: 99.9 % lie below 26.1.
  EXPECT_LT(squares, 26.1);
  EXPECT_LT(worst, 0.01);
}

TEST(NominalAlign, MovesOnlyAsAllowedByMarkedSamplesAlone) {
  const NominalMesh mesh = plateMesh();
  const RigidMotion truth = motionBy({-1.0, -1.0, 0.25}, {0.6, -0.4, 0.0});
  const Grid grid = scanGrid(0.1, 0.1);
  AlignOptions options;
  options.moves = {.shift = false, .rotation = false, .tilt = true};
  // Where the files place the mesh, level moves keep it.
  Grid placed = grid;
  placed.origin_x = 1.0;
  placed.origin_y = 1.0;
  const Version clean = scanOf(mesh, truth, placed, 0.0, 1);
  // The right half 2 mm too high, and not marked.
  std::vector<float> heights;
  std::vector<std::uint8_t> marks;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      const bool left = c < grid.width / 2;
      heights.push_back(clean.reader().heightAt(c, r) + (left ? 0.0F : 2.0F));
      marks.push_back(left ? 1 : 0);
    }
  options.region = Region::kMarked;
  JobControl job;
  const auto found = alignNominal(makeField(placed, heights, marks), mesh, options, job);
  ASSERT_TRUE(found) << found.error().line();
  // The turn is about the marked samples' height, 0.45 mm over that of the truth: 0.7 degrees of that are 5.6e-3 mm across.
  EXPECT_LT(placesApart(found->motion, truth), 6e-3);
  EXPECT_LT(found->samples, grid.samples() / 2 + 1);
}

TEST(NominalAlign, RefusesWhatDoesNotDecideAMotion) {
  JobControl job;
  const NominalMesh flat = meshOf(surfaceOver(14, 12, 10, 10, [](double x, double) { return 0.1 * x; }));
  const Grid grid = scanGrid(0.1, 0.1);
  const Version part = scanOf(flat, motionBy({-1, -1, 0}, glm::dvec3(0.0)), grid, 0.001, 1);
  const auto sliding = alignNominal(part, flat, {}, job);
  ASSERT_FALSE(sliding);
  EXPECT_NE(sliding.error().what.find("does not decide"), std::string::npos) << sliding.error().line();
  AlignOptions level;
  level.moves = {.shift = false, .rotation = false, .tilt = true};
  EXPECT_TRUE(alignNominal(part, flat, level, job));
  const Version holes = makeField(grid, std::vector<float>(static_cast<std::size_t>(grid.samples()),
                                                           std::numeric_limits<float>::quiet_NaN()));
  EXPECT_FALSE(alignNominal(holes, flat, {}, job));
  // One triangle smaller than a sample.
  EXPECT_FALSE(alignNominal(
      part, meshOf({{glm::dvec3(0, 0, 0), glm::dvec3(0.01, 0, 0), glm::dvec3(0, 0.01, 0)}}), {}, job));
  JobControl stopped;
  stopped.cancel();
  const auto none = alignNominal(part, flat, level, stopped);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::kCancelled);
}

TEST(NominalAlign, IsTheSameForAnyNumberOfThreads) {
  const NominalMesh mesh = plateMesh();
  const Version part =
      scanOf(mesh, motionBy({-0.7, -1.1, 0.2}, {0.3, 0.2, 2.0}), scanGrid(0.1, 0.1), 0.01, 3);
  std::vector<std::array<double, 16>> found;
  for (const int threads : {1, 5}) {
    tbb::task_arena arena(threads);
    arena.execute([&] {
      JobControl job;
      const auto alignment = alignNominal(part, mesh, {}, job);
      ASSERT_TRUE(alignment);
      found.push_back(alignment->motion.matrix());
    });
  }
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0], found[1]);
}

}  // namespace
}  // namespace fettle::engine
