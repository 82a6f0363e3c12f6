// A part cut into overlapping scans, each with a shift, a tilt, a rotation and noise of its own, put together again.

#include "engine/mosaic/overlap_motions.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "engine/compare/compare.h"
#include "engine/mosaic/blended.h"
#include "tests/engine/mosaic/parts.h"
#include "tests/support/no_data.h"

namespace fettle::engine {
namespace {

constexpr double kNoise = 0.005;
constexpr double kHole = std::numeric_limits<double>::quiet_NaN();

// 2 x 2 scans of 8 x 8 mm, 20 % of a side in common.
struct CutPart {
  std::vector<Version> scans;
  std::vector<RigidMotion> motions;  // from the part's coordinates to each scan's
  std::vector<glm::dvec3> middles;
};

CutPart cutPart(double noise, double sx = 0.05, double sy = 0.05, bool stated = false,
                const std::function<double(int, int, double)>& damage = {}) {
  CutPart cut;
  const glm::dvec3 off[4] = {{0, 0, 0}, {0.21, -0.13, 0.3}, {-0.17, 0.24, -1.2}, {0.11, 0.19, 20.0}};
  const glm::dvec3 turn[4] = {{0, 0, 0}, {0.3, -0.2, 0.8}, {-0.4, 0.1, -1.1}, {0.2, 0.35, 0.5}};
  for (int k = 0; k < 4; ++k) {
    const double x = 6.4 * (k % 2), y = 6.4 * (k / 2);
    // About the scan's middle: first what lies under it moves there.
    RigidMotion motion{glm::dmat3(1.0), glm::dvec3(-x, -y, 0.0), glm::dvec3(4.0, 4.0, 0.0)};
    motion = motion.then(off[k], turn[k] * (std::numbers::pi / 180.0));
    Grid grid = gridFor(static_cast<int>(8.0 / sx) + 1, static_cast<int>(8.0 / sy) + 1, sx, sy);
    if (stated) {
      grid.origin_x = 5e6 + x;
      grid.origin_y = -5e6 + y;
    }
    cut.motions.push_back(motion);
    cut.scans.push_back(scanOfHills(grid, motion, noise, static_cast<std::uint64_t>(k + 1), damage));
    cut.middles.emplace_back(4.0, 4.0, off[k].z);
  }
  return cut;
}

Result<AdjustedPoses> posesOf(const CutPart& cut, const std::optional<std::vector<glm::dvec2>>& places) {
  JobControl job;
  const auto found = overlapMotions(cut.scans, places, 0.8, {}, {}, job);
  EXPECT_TRUE(found) << found.error().line();
  for (const FailedPair& pair : found->failed)
    std::printf("  pair %zu, %zu: %s\n", pair.first, pair.second, pair.reason.line().c_str());
  auto poses = adjustPoses(cut.middles, found->pairs, {});

  EXPECT_TRUE(poses) << poses.error().line();
  return poses;
}

// How far a scan's corners are from where they truly lie in the first scan, at most.
double worstCorner(const CutPart& cut, const AdjustedPoses& poses, std::size_t k) {
  double worst = 0.0;
  for (const double x : {0.0, 8.0})
    for (const double y : {0.0, 8.0}) {
      const glm::dvec3 p(x, y, cut.middles[k].z), truth = cut.motions[0].moved(cut.motions[k].movedBack(p));
      worst = std::max(worst, glm::length(poses.poses[k].moved(p) - truth));
    }
  return worst;
}

TEST(OverlapMotions, PutACutPartTogetherAndTheSeamsAreThatOfTheNoise) {
  const CutPart cut = cutPart(kNoise);
  const auto adjusted = posesOf(cut, placesInRows(cut.scans, 2, 0.2));
  ASSERT_TRUE(adjusted);
  const AdjustedPoses& poses = *adjusted;
  EXPECT_EQ(poses.freedom, 6 * (6 - 3));  // six pairs, the diagonal ones among them
  EXPECT_LT(poses.misfit, 2.5 * poses.freedom);
  JobControl job;
  const auto grid = gridOverAll(cut.scans, poses);
  ASSERT_TRUE(grid);
  const auto blended = blendedScans(cut.scans, poses, *grid, Blend::kFade, job);
  ASSERT_TRUE(blended);
  // Residual against the truth in the first scan's coordinates: rms, and means over squares of 10 x 10 samples, in which
  // noise is a tenth and a seam would stay.
  const auto left = static_cast<int>(std::lround(grid->origin_x / 0.05)),
             lower = static_cast<int>(std::lround(grid->origin_y / 0.05));
  double squares = 0.0, worst = 0.0, of_blocks = 0.0;
  std::int64_t samples = 0, blocks = 0;
  for (int r = 0; r + 10 <= grid->height; r += 10)
    for (int c = 0; c + 10 <= grid->width; c += 10) {
      double sum = 0.0;
      int here = 0;
      for (int j = r; j < r + 10; ++j)
        for (int i = c; i < c + 10; ++i) {
          const double z = blended->reader().heightAt(i, j);
          if (std::isnan(z)) continue;
          const double d = z - movedHills(cut.motions[0], (i + left) * 0.05, (j + lower) * 0.05);
          sum += d;
          squares += d * d;
          ++here;
        }
      samples += here;
      if (here < 80) continue;
      of_blocks += sum * sum / (here * here);
      ++blocks;
      worst = std::max(worst, std::abs(sum / here));
    }
  const auto overlaps = overlapDeviations(cut.scans, poses, job);
  ASSERT_TRUE(overlaps);
  std::printf(
      "2 x 2 scans, noise %.0f um: residual %.2f um rms, of means over 0.5 x 0.5 mm %.2f um rms and %.2f at "
      "most\n",
      1e3 * kNoise, 1e3 * std::sqrt(squares / static_cast<double>(samples)),
      1e3 * std::sqrt(of_blocks / static_cast<double>(blocks)), 1e3 * worst);
  for (const OverlapDeviation& one : *overlaps) {
    std::printf("  %zu over %zu: %.3f +- %.3f um, spread %.2f um, %d places\n", one.second, one.first,
                1e3 * one.median, 1e3 * one.height_error, 1e3 * one.spread, static_cast<int>(one.places));
    // The median of n places scatters by 1.25 sigma / sqrt(n) itself; the patch between samples smooths one of both.
    EXPECT_LT(std::abs(one.median), 4.0 * (one.height_error + 1.3 * 1.4 * kNoise / std::sqrt(one.places)));
    EXPECT_GT(one.spread, 0.8 * kNoise);
    EXPECT_LT(one.spread, 1.5 * kNoise);
  }
  EXPECT_EQ(overlaps->size(), 6U);
  std::printf("  pairs: misfit %.1f of %d\n", poses.misfit, poses.freedom);
  for (std::size_t k = 1; k < 4; ++k) {
    // The corner farthest from the first scan's middle.
    const glm::dvec3 p(k == 2 ? 0.0 : 8.0, k == 1 ? 0.0 : 8.0, cut.middles[k].z),
        truth = cut.motions[0].moved(cut.motions[k].movedBack(p));
    const double off = (poses.poses[k].moved(p) - truth).z, error = poses.heightError(0, k, truth);
    std::printf(
        "  scan %zu: far corner off by %.2f um in height, stated +- %.2f um; its corners in space by at most "
        "%.2f um\n",
        k, 1e3 * off, 1e3 * error, 1e3 * worstCorner(cut, poses, k));
    EXPECT_LT(std::abs(off), 4.0 * error);
    EXPECT_LT(worstCorner(cut, poses, k), kNoise);
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(samples)), kNoise);
  // A tenth of the noise at 4.5 standard deviations, bilinear patches of 0.05^2 / 8 times at most 4 / mm, and corners that
  // lie 8 mm beyond the overlaps by which their tilt is known.
  EXPECT_LT(worst, kNoise);
}

TEST(OverlapMotions, WorkByStatedPlacesFarAwayAndByNone) {
  const CutPart stated = cutPart(kNoise, 0.1, 0.1, true);
  const auto places = statedPlaces(stated.scans);
  ASSERT_TRUE(places);
  EXPECT_NEAR((*places)[3].x, 6.4, 1e-8);
  const auto far = posesOf(stated, places);
  ASSERT_TRUE(far);
  for (std::size_t k = 1; k < 4; ++k) EXPECT_LT(worstCorner(stated, *far, k), 2.0 * kNoise) << k;
  // Searched for, where a fifth is in common: two of 8 mm that share 4.8.
  CutPart two;
  for (const double x : {0.0, 3.2}) {
    RigidMotion motion{glm::dmat3(1.0), {-x, 0.0, 0.0}, {4.0, 4.0, 0.0}};
    two.motions.push_back(motion);
    two.scans.push_back(
        scanOfHills(gridFor(81, 81, 0.1, 0.1), motion, kNoise, 5 + static_cast<std::uint64_t>(x)));
    two.middles.emplace_back(4.0, 4.0, 0.0);
  }
  EXPECT_FALSE(statedPlaces(two.scans));
  const auto searched = posesOf(two, std::nullopt);
  ASSERT_TRUE(searched);
  EXPECT_LT(worstCorner(two, *searched, 1), 2.0 * kNoise);
}

TEST(OverlapMotions, StandHolesSpikesAndUnequalSpacing) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const CutPart cut = cutPart(kNoise, 0.025, 0.1, false, [&](int, int, double z) {
    const double what = share(random);
    return what < 0.02 ? kHole : what < 0.022 ? 1e6 : z;
  });
  const auto adjusted = posesOf(cut, placesInRows(cut.scans, 2, 0.2));
  ASSERT_TRUE(adjusted);
  const AdjustedPoses& poses = *adjusted;
  for (std::size_t k = 1; k < 4; ++k) EXPECT_LT(worstCorner(cut, poses, k), 4.0 * kNoise) << k;
  JobControl job;
  const auto grid = gridOverAll(cut.scans, poses);
  ASSERT_TRUE(grid);
  EXPECT_LT(grid->width, 15 * 40);  // no spike makes it wider
  const auto blended = blendedScans(cut.scans, poses, *grid, Blend::kFade, job);
  ASSERT_TRUE(blended);
  const auto overlaps = overlapDeviations(cut.scans, poses, job);
  ASSERT_TRUE(overlaps);
  for (const OverlapDeviation& one : *overlaps) {
    EXPECT_TRUE(std::isfinite(one.median) && std::isfinite(one.rms));
    EXPECT_LT(std::abs(one.median), kNoise);
  }
}

// Two scans of a grid of waves 2.5 mm long: without places every period is as good; by places that are known to 0.8 mm none but one.
TEST(OverlapMotions, OfASurfaceThatRepeatsItselfSayWhichPairsFitElsewhere) {
  const auto waves = [](double from, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal(0.0, kNoise);
    const Grid grid = gridFor(161, 121, 0.1, 0.1);
    std::vector<float> heights;
    for (int r = 0; r < grid.height; ++r)
      for (int c = 0; c < grid.width; ++c)
        heights.push_back(
            static_cast<float>(0.03 * std::sin(2.0 * std::numbers::pi * (0.1 * c + from) / 2.5) +
                               0.03 * std::sin(2.0 * std::numbers::pi * 0.1 * r / 2.5) + normal(random)));
    return makeField(grid, heights);
  };
  const std::vector<Version> scans{waves(0.0, 1), waves(7.8, 2)};
  JobControl job;
  const auto anywhere = overlapMotions(scans, std::nullopt, 0.8, {}, {}, job);
  ASSERT_TRUE(anywhere) << anywhere.error().line();
  ASSERT_EQ(anywhere->repeated.size(), 1U);
  EXPECT_NEAR(glm::length(anywhere->repeated.front().shift), 2.5, 0.03);
  const std::vector<glm::dvec2> places{glm::dvec2(0.0), glm::dvec2(7.8, 0.0)};
  const auto known = overlapMotions(scans, places, 0.8, {}, {}, job);
  ASSERT_TRUE(known) << known.error().line();
  ASSERT_EQ(known->pairs.size(), 1U);
  EXPECT_NEAR(known->pairs.front().motion.shift.x, 7.8, 0.03);
  EXPECT_TRUE(known->repeated.empty());
}

// Who joins scans has given files and no A and B.
TEST(OverlapMotions, AReasonCallsTheScansByTheirNames) {
  JobControl job;
  const Version hole = makeField(gridFor(60, 60, 0.1, 0.1), std::vector<float>(3600, kNan)),
                row = makeField(gridFor(60, 1, 0.1, 0.1), std::vector<float>(60, 0.0F));
  const std::vector<Version> scans{row, cutPart(kNoise, 0.1, 0.1).scans.front(), hole};
  const auto found = overlapMotions(scans, std::nullopt, 0.5, {}, {"row.tif", "part.tif", "hole.tif"}, job);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->failed.size(), 3U);
  const auto reason = [&](std::size_t k) { return found->failed[k].reason; };
  EXPECT_NE(reason(0).what.find("heights of row.tif are whole"), std::string::npos) << reason(0).line();
  EXPECT_EQ(reason(0).where, "row.tif");
  EXPECT_EQ(reason(1).where, "hole.tif");
  EXPECT_EQ(reason(2).where, "hole.tif");
}

TEST(OverlapMotions, NeitherInventOverlapsNorHideWhyNot) {
  // Two scans whose stated places are apart; two that overlap on a plane; one without a height; one row.
  JobControl job;
  std::vector<Version> scans = cutPart(kNoise, 0.1, 0.1).scans;
  scans.resize(2);
  const auto apart = overlapMotions(scans, std::vector<glm::dvec2>{{0, 0}, {9, 0}}, 0.5, {}, {}, job);
  ASSERT_TRUE(apart);
  EXPECT_TRUE(apart->pairs.empty());
  EXPECT_TRUE(apart->failed.empty());
  std::vector<Version> planes;
  for (const double up : {0.0, 1.0})
    planes.push_back(makeField(gridFor(60, 60, 0.1, 0.1), std::vector<float>(3600, static_cast<float>(up))));
  planes.push_back(makeField(gridFor(60, 60, 0.1, 0.1),
                             std::vector<float>(3600, std::numeric_limits<float>::quiet_NaN())));
  planes.push_back(makeField(gridFor(60, 1, 0.1, 0.1), std::vector<float>(60, 0.0F)));
  const auto flat = overlapMotions(planes, std::nullopt, 0.5, {}, {}, job);
  ASSERT_TRUE(flat);
  EXPECT_TRUE(flat->pairs.empty());
  EXPECT_EQ(flat->failed.size(), 6U);
  for (const FailedPair& pair : flat->failed) EXPECT_FALSE(pair.reason.what.empty());
  // Heights alone decide what planes do.
  AlignOptions level;
  level.moves = {.shift = false, .rotation = false, .tilt = true};
  planes.resize(2);
  const auto found = overlapMotions(planes, std::vector<glm::dvec2>{{0, 0}, {3, 0}}, 0.0, level, {}, job);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->pairs.size(), 1U);
  EXPECT_NEAR(found->pairs[0].motion.shift.z, -1.0, 1e-6);
  EXPECT_NEAR(found->pairs[0].motion.shift.x, 3.0, 1e-9);
}

}  // namespace
}  // namespace fettle::engine
