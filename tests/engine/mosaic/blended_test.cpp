// What becomes of overlapping scans whose places are known.

#include "engine/mosaic/blended.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "engine/mosaic/rim_map.h"
#include "tests/engine/mosaic/parts.h"

namespace fettle::engine {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

// Scans at places in the first's coordinates, not turned.
AdjustedPoses posesAt(const std::vector<glm::dvec3>& places) {
  AdjustedPoses poses;
  for (const glm::dvec3& place : places) poses.poses.push_back({glm::dmat3(1.0), place, glm::dvec3(0.0)});
  poses.covariance.assign(36 * (places.size() - 1) * (places.size() - 1), 0.0);
  return poses;
}

Version levelScan(int width, int height, float z) {
  return makeField(gridFor(width, height, 0.5, 0.25),
                   std::vector<float>(static_cast<std::size_t>(width * height), z));
}

Version blendOf(const std::vector<Version>& scans, const AdjustedPoses& poses, Blend blend) {
  JobControl job;
  const auto grid = gridOverAll(scans, poses);
  EXPECT_TRUE(grid);
  auto blended = blendedScans(scans, poses, *grid, blend, job);
  EXPECT_TRUE(blended);
  return *std::move(blended);
}

TEST(Blended, FadesWithoutAStepAndMeansWithOne) {
  // 41 x 41 samples each, 0.5 x 0.25 mm apart; the second 1 higher, ten columns and no row further.
  const std::vector<Version> scans{levelScan(41, 41, 2.0F), levelScan(41, 41, 3.0F)};
  const AdjustedPoses poses = posesAt({{0, 0, 0}, {15.0, 0, 0}});
  const Version fade = blendOf(scans, poses, Blend::kFade), mean = blendOf(scans, poses, Blend::kMean),
                first = blendOf(scans, poses, Blend::kFirst);
  ASSERT_EQ(fade.grid().width, 71);
  ASSERT_EQ(fade.grid().height, 41);
  for (int r = 0; r < 41; ++r)
    for (int c = 0; c < 71; ++c) {
      const double z = fade.reader().heightAt(c, r);
      if (c > 0) {
        // Over the 5 mm in common from 2 to 3: at most 0.1 a sample on middle rows, 0.5 on the lowest, which are rims of both.
        EXPECT_GE(z, double{fade.reader().heightAt(c - 1, r)} - 1e-6);
      }
      EXPECT_GE(z, 2.0);
      EXPECT_LE(z, 3.0);
      EXPECT_EQ(mean.reader().heightAt(c, r), c < 30 ? 2.0F : c <= 40 ? 2.5F : 3.0F);
      EXPECT_EQ(first.reader().heightAt(c, r), c <= 40 ? 2.0F : 3.0F);
    }
  // In the middle row the weights are the distances to both ends: linear.
  for (int c = 30; c <= 40; ++c) EXPECT_NEAR(fade.reader().heightAt(c, 20), 2.0 + (c - 30) / 10.0, 1e-5);
}

TEST(Blended, FillsHolesFromTheOthersAndTakesMarksAlong) {
  std::vector<float> holed(41 * 41, 2.0F);
  std::vector<std::uint8_t> marks(41 * 41, 0);
  for (int r = 10; r < 20; ++r)
    for (int c = 33; c < 38; ++c) holed[static_cast<std::size_t>(41 * r + c)] = kNone;
  holed[5 * 41 + 3] = kNone;
  marks[7 * 41 + 4] = 1;
  const std::vector<Version> scans{makeField(gridFor(41, 41, 0.5, 0.25), holed, marks),
                                   levelScan(41, 41, 3.0F)};
  const Version fade = blendOf(scans, posesAt({{0, 0, 0}, {15.0, 0, 0}}), Blend::kFade);
  for (int r = 11; r < 19; ++r)
    for (int c = 34; c < 37; ++c) EXPECT_EQ(fade.reader().heightAt(c, r), 3.0F);
  EXPECT_TRUE(std::isnan(fade.reader().heightAt(3, 5)));
  EXPECT_TRUE(fade.reader().markedAt(4, 7));
  EXPECT_FALSE(fade.reader().markedAt(5, 7));
}

TEST(Blended, KeepsTheSamplesOfTheFirstAndTheWorld) {
  Grid grid = gridFor(30, 20, 0.1, 0.4);
  grid.origin_x = 5e6 + 0.3;
  grid.origin_y = -5e6;
  grid.height_unit = {"um", 1e-3};
  grid.height_per_count = 0.02;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> height(-900.0F, 900.0F);
  std::vector<float> z(600);
  for (float& v : z) v = height(random);
  const Version first = makeField(grid, z);
  Grid other = gridFor(10, 10, 0.3, 0.3);
  const Version second = makeField(other, std::vector<float>(100, 0.25F));
  const Version all = blendOf({first, second}, posesAt({{0, 0, 0}, {-2.05, -1.0, 0.0}}), Blend::kFirst);
  // It begins 2.05 mm left and 1 mm below: the samples of the first reach to 2.0 and 0.8.
  EXPECT_EQ(all.grid().width, 50);
  EXPECT_EQ(all.grid().height, 22);
  EXPECT_NEAR(all.grid().origin_x, 5e6 - 1.7, 1e-8);
  EXPECT_EQ(all.grid().height_unit.name, "um");
  EXPECT_EQ(all.grid().height_per_count, 0.0);
  for (int r = 0; r < 20; ++r)
    for (int c = 0; c < 30; ++c)
      EXPECT_NEAR(all.reader().heightAt(c + 20, r + 2), z[static_cast<std::size_t>(30 * r + c)], 1e-4);
  EXPECT_EQ(all.reader().heightAt(2, 3), 250.0F);
  EXPECT_TRUE(std::isnan(all.reader().heightAt(2, 21)));
  // More than a field may have.
  const auto wide = gridOverAll({first, second}, posesAt({{0, 0, 0}, {3e4, 0, 0}}));
  ASSERT_FALSE(wide);
  EXPECT_EQ(wide.error().kind, ErrorKind::kInput);
}

// A level scan that is tilted covers the shadow of its four corners, wherever the point about which it is turned lies.
TEST(Blended, TheGridReachesToTheCornersOfATiltedScanAndNotBeyond) {
  const Version first = levelScan(41, 41, 0.0F);
  for (const double turn : {-0.3, 0.3})
    for (const double middle : {-4.0, 0.0, 5.0})
      for (const float z : {-3.0F, 0.0F, 2.0F}) {
        const Version second = levelScan(61, 33, z);
        AdjustedPoses poses = posesAt({{0, 0, 0}, {0, 0, 0}});
        poses.poses[1] = RigidMotion{glm::dmat3(1.0), {3.0, -1.0, 0.0}, {15.0, 4.0, middle}}.then(
            {0, 0, 0}, {0.0, turn, 0.0});
        const auto grid = gridOverAll({first, second}, poses);
        ASSERT_TRUE(grid);
        double left = 0.0, right = 20.0, lower = 0.0, upper = 10.0;  // of the first
        for (const double x : {0.0, 30.0})
          for (const double y : {0.0, 8.0}) {
            const glm::dvec3 corner = poses.poses[1].moved({x, y, z});
            left = std::min(left, corner.x), right = std::max(right, corner.x);
            lower = std::min(lower, corner.y), upper = std::max(upper, corner.y);
          }
        const double last_x = grid->origin_x + 0.5 * (grid->width - 1),
                     last_y = grid->origin_y + 0.25 * (grid->height - 1);
        // The samples within: none of them beyond, and no room for another.
        EXPECT_GE(grid->origin_x, left - 1e-6);
        EXPECT_LT(grid->origin_x, left + 0.5);
        EXPECT_LE(last_x, right + 1e-6);
        EXPECT_GT(last_x, right - 0.5);
        EXPECT_GE(grid->origin_y, lower - 1e-6);
        EXPECT_LT(grid->origin_y, lower + 0.25);
        EXPECT_LE(last_y, upper + 1e-6);
        EXPECT_GT(last_y, upper - 0.25);
      }
}

// A spike of a kilometre on a tilted scan widens the grid by no more than the scan is long.
TEST(Blended, ASpikeDoesNotWidenTheGridWithoutEnd) {
  std::vector<float> z(41 * 41, 0.0F);
  z[41 * 20 + 20] = 1e6F;
  const std::vector<Version> scans{levelScan(41, 41, 0.0F), makeField(gridFor(41, 41, 0.5, 0.25), z)};
  AdjustedPoses poses = posesAt({{0, 0, 0}, {0, 0, 0}});
  poses.poses[1] = RigidMotion{glm::dmat3(1.0), {0, 0, 0}, {10.0, 5.0, 0.0}}.then({0, 0, 0}, {0.0, 0.3, 0.0});
  const auto grid = gridOverAll(scans, poses);
  ASSERT_TRUE(grid);
  EXPECT_LE(grid->width, 41 + 2 * 41);
}

TEST(Blended, IsTheSameForAnyNumberOfThreads) {
  const RigidMotion still, turned = RigidMotion{glm::dmat3(1.0), {-3.0, -1.0, 0.0}, {4, 3, 0}}.then(
                               {0, 0, 0.1}, {0.01, 0.0, 0.05});
  const std::vector<Version> scans{scanOfHills(gridFor(120, 90, 0.05, 0.07), still, 0.01, 1),
                                   scanOfHills(gridFor(110, 140, 0.06, 0.05), turned, 0.01, 2)};
  AdjustedPoses poses = posesAt({{0, 0, 0}, {0, 0, 0}});
  poses.poses[1] = {
      glm::transpose(turned.rotation), turned.movedBack({4, 3, 0}) - glm::dvec3(4, 3, 0), {4, 3, 0}};
  std::vector<std::uint64_t> hashes;
  for (const int threads : {1, 3, 8}) {
    tbb::task_arena arena(threads);
    arena.execute([&] { hashes.push_back(contentHash(blendOf(scans, poses, Blend::kFade))); });
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

TEST(RimMap, HasTheDistancesOfAPlainSearch) {
  // 1 sample a block: exact between blocks' middles. A round hole and a few more.
  const Grid grid = gridFor(60, 50, 0.5, 0.25);
  std::vector<float> z(3000, 1.0F);
  for (int r = 0; r < 50; ++r)
    for (int c = 0; c < 60; ++c)
      if (std::hypot(0.5 * (c - 20), 0.25 * (r - 25)) < 2.0 || (c == 50 && r == 40))
        z[static_cast<std::size_t>(60 * r + c)] = kNone;
  JobControl job;
  const auto map = RimMap::create(makeField(grid, z), job);
  ASSERT_TRUE(map);
  for (int r = 1; r < 49; ++r)
    for (int c = 1; c < 59; ++c) {
      double nearest = std::min({0.5 * c, 0.5 * (59 - c), 0.25 * r, 0.25 * (49 - r)});
      for (int j = 0; j < 50; ++j)
        for (int i = 0; i < 60; ++i)
          if (std::isnan(z[static_cast<std::size_t>(60 * j + i)]))
            nearest = std::min(nearest, std::hypot(0.5 * (i - c), 0.25 * (j - r)));
      EXPECT_NEAR(map->at(0.5 * c, 0.25 * r), std::max(nearest, 0.25e-6), 1e-9) << c << ' ' << r;
    }
  // One row, one sample, all holes: positive, finite.
  for (const auto& [w, h] : {std::pair{30, 1}, {1, 30}, {1, 1}}) {
    const auto small = RimMap::create(levelScan(w, h, 1.0F), job);
    ASSERT_TRUE(small);
    EXPECT_GT(small->at(0.0, 0.0), 0.0);
    EXPECT_TRUE(std::isfinite(small->at(0.25 * (w - 1), 0.0)));
  }
  // Blocks of 2 x 2 and more of a large field: to about a block.
  std::vector<float> large(600 * 300, 1.0F);
  for (int r = 100; r < 200; ++r)
    for (int c = 250; c < 350; ++c) large[static_cast<std::size_t>(600 * r + c)] = kNone;
  const auto coarse = RimMap::create(makeField(gridFor(600, 300, 1.0, 1.0), large), job);
  ASSERT_TRUE(coarse);
  EXPECT_NEAR(coarse->at(230.0, 150.0), 20.0, 3.0);
  EXPECT_NEAR(coarse->at(150.0, 150.0), 100.0, 3.0);
  EXPECT_NEAR(coarse->at(40.0, 150.0), 40.0, 1e-9);
}

}  // namespace
}  // namespace fettle::engine
