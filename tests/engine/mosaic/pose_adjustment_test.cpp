// The adjustment of all poses at once: known poses from pairs with known noise, loops, scans that nothing joins.

#include "engine/mosaic/pose_adjustment.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <random>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace fettle::engine {
namespace {

constexpr double kDegrees = std::numbers::pi / 180.0;

RigidMotion motionAbout(const glm::dvec3& centre, const glm::dvec3& shift, const glm::dvec3& turn) {
  return RigidMotion{glm::dmat3(1.0), glm::dvec3(0.0), centre}.then(shift, turn);
}

// From the second's coordinates to the first's, where both poses are known.
RigidMotion between(const RigidMotion& first, const RigidMotion& second, const glm::dvec3& centre) {
  const glm::dmat3 rotation = glm::transpose(first.rotation) * second.rotation;
  return {rotation, first.movedBack(second.moved(centre)) - centre, centre};
}

// Four scans of 10 x 8 mm in two columns and rows, each in a pose of its own.
std::vector<RigidMotion> truePoses() {
  const glm::dvec3 middle(5.0, 4.0, 0.5);
  return {motionAbout(middle, glm::dvec3(0.0), glm::dvec3(0.0)),
          motionAbout(middle, {8.1, 0.2, 0.3}, {0.01, -0.02, 3.0 * kDegrees}),
          motionAbout(middle, {-0.2, 6.4, -0.1}, {-0.01, 0.005, -2.0 * kDegrees}),
          motionAbout(middle, {8.0, 6.3, 40.0}, {0.02, 0.01, 5.0 * kDegrees})};
}
const std::vector<glm::dvec3> kMiddles(4, glm::dvec3(5.0, 4.0, 0.5));

// A pair with noise of the covariance that it states.
PairMotion noisyPair(std::size_t first, std::size_t second, const glm::dvec3& centre, std::mt19937_64& random,
                     double scale) {
  std::normal_distribution<double> normal(0.0, 1.0);
  const std::vector<RigidMotion> poses = truePoses();
  const double sigma[6] = {2e-3, 1e-3, 1e-4, 5e-5, 8e-5, 3e-4};
  double d[6];
  for (double& v : d) v = normal(random);
  // A shift along x that goes with one along y.
  d[1] = 0.8 * d[0] + 0.6 * d[1];
  PairMotion pair{first, second, between(poses[first], poses[second], centre), {}};
  for (std::size_t k = 0; k < 6; ++k) pair.covariance[7 * k] = sigma[k] * sigma[k];
  pair.covariance[1] = pair.covariance[6] = 0.8 * sigma[0] * sigma[1];
  for (std::size_t k = 0; k < 6; ++k) d[k] *= scale * sigma[k];
  // Shift and turn about the centre, which lies in the first scan.
  const RigidMotion more = motionAbout(centre, {d[0], d[1], d[2]}, {d[3], d[4], d[5]});
  pair.motion = {more.rotation * pair.motion.rotation, more.moved(pair.motion.moved(centre)) - centre,
                 centre};
  return pair;
}

std::vector<PairMotion> loopOfPairs(std::uint64_t seed, double scale) {
  std::mt19937_64 random(seed);
  // Centres in the coordinates of the first of each, in its overlap.
  return {noisyPair(0, 1, {9.0, 4.0, 0.4}, random, scale), noisyPair(0, 2, {5.0, 7.2, 0.6}, random, scale),
          noisyPair(1, 3, {5.0, 7.2, 0.5}, random, scale), noisyPair(2, 3, {9.0, 4.0, 0.2}, random, scale),
          noisyPair(0, 3, {9.2, 7.1, 0.2}, random, scale)};
}

TEST(PoseAdjustment, FindsPosesFromPairsWithoutNoise) {
  const auto found = adjustPoses(kMiddles, loopOfPairs(1, 0.0), {});
  ASSERT_TRUE(found);
  const std::vector<RigidMotion> truth = truePoses();
  for (std::size_t k = 0; k < 4; ++k)
    for (const glm::dvec3& p : {glm::dvec3(0, 0, 0), glm::dvec3(10, 0, 0), glm::dvec3(0, 8, 5)})
      EXPECT_LT(glm::length(found->poses[k].moved(p) - truth[k].moved(p)), 1e-9) << k;
  EXPECT_EQ(found->freedom, 12);
  EXPECT_LT(found->misfit, 1e-6);
  EXPECT_EQ(found->factor, 1.0);
}

TEST(PoseAdjustment, StatesErrorsThatCoverTheTruth) {
  // Of the last scan in a corner: six figures against the covariance, chi^2 of 6 per seed; the misfit, chi^2 of 12.
  constexpr int kSeeds = 400;
  double poses = 0.0, misfits = 0.0, height = 0.0;
  const std::vector<RigidMotion> truth = truePoses();
  for (int seed = 0; seed < kSeeds; ++seed) {
    const auto found = adjustPoses(kMiddles, loopOfPairs(static_cast<std::uint64_t>(seed), 1.0), {});
    ASSERT_TRUE(found);
    misfits += found->misfit;
    const glm::dvec3 corner = truth[3].moved({10.0, 8.0, 0.0});
    const double error = found->heightError(0, 3, corner) / found->factor;
    const double off = (found->poses[3].moved({10.0, 8.0, 0.0}) - corner).z;
    height += off * off / (error * error);
    const auto c = found->between(0, 3, corner);
    const glm::dvec3 moved = found->poses[3].moved({10.0, 8.0, 0.0}) - corner;
    poses += moved.x * moved.x / (c[0] / (found->factor * found->factor));
  }
  std::printf("%d seeds: misfit %.2f of 12, height and x of a far corner %.3f and %.3f of their variance\n",
              kSeeds, misfits / kSeeds, height / kSeeds, poses / kSeeds);
  // Means of 400: 12 +- 0.25, 1 +- 0.07; four standard deviations.
  EXPECT_NEAR(misfits / kSeeds, 12.0, 1.0);
  EXPECT_NEAR(height / kSeeds, 1.0, 0.28);
  EXPECT_NEAR(poses / kSeeds, 1.0, 0.28);
}

TEST(PoseAdjustment, IsBetterThanAChainAndKnowsWhenPairsDisagree) {
  double chain = 0.0, all = 0.0;
  const std::vector<RigidMotion> truth = truePoses();
  const glm::dvec3 middle(5.0, 4.0, 0.5);
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    std::vector<PairMotion> pairs = loopOfPairs(seed, 1.0);
    const auto found = adjustPoses(kMiddles, pairs, {});
    const auto by_chain = adjustPoses(kMiddles, {pairs[0], pairs[1], pairs[2]}, {});
    ASSERT_TRUE(found && by_chain);
    EXPECT_EQ(by_chain->freedom, 0);
    all += std::pow(glm::length(found->poses[3].moved(middle) - truth[3].moved(middle)), 2);
    chain += std::pow(glm::length(by_chain->poses[3].moved(middle) - truth[3].moved(middle)), 2);
  }
  EXPECT_LT(all, 0.5 * chain);
  // Pairs five times as far off as they state: their errors grow by about that.
  const auto wrong = adjustPoses(kMiddles, loopOfPairs(7, 5.0), {});
  ASSERT_TRUE(wrong);
  EXPECT_GT(wrong->factor, 2.5);
  EXPECT_LT(wrong->factor, 8.0);
}

TEST(PoseAdjustment, NamesAScanThatNothingJoins) {
  std::vector<PairMotion> pairs = loopOfPairs(1, 0.0);
  pairs.resize(2);  // 0 with 1 and 2
  const auto found = adjustPoses(kMiddles, pairs, {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().where, "3");
  EXPECT_EQ(found.error().kind, ErrorKind::kInput);
}

TEST(PoseAdjustment, MovesOnlyWhatIsFree) {
  // Shifts alone: turns stay, and have no covariance.
  std::vector<PairMotion> pairs;
  for (const auto& [a, b, x, y] :
       {std::tuple{0U, 1U, 8.0, 0.0}, {0U, 2U, 0.0, 6.0}, {1U, 3U, 0.0, 6.01}, {2U, 3U, 8.0, 0.0}}) {
    PairMotion pair{a, b, motionAbout({5, 4, 0}, {x, y, 0.1}, glm::dvec3(0.0)), {}};
    for (const std::size_t k : {0U, 7U, 14U}) pair.covariance[k] = 1e-6;
    pairs.push_back(pair);
  }
  const auto found = adjustPoses(kMiddles, pairs, {.shift = true, .rotation = false, .tilt = false});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->freedom, 3);
  for (const RigidMotion& pose : found->poses) EXPECT_EQ(pose.rotation, glm::dmat3(1.0));
  // The loop is off by 0.01 along y: a quarter of it in each pair.
  EXPECT_NEAR(found->poses[3].shift.y, 6.005, 1e-9);
  EXPECT_NEAR(found->poses[2].shift.y, 6.0025, 1e-9);
  EXPECT_NEAR(found->poses[1].shift.y, -0.0025, 1e-9);
}

}  // namespace
}  // namespace fettle::engine
