#include "engine/suggest/noise_match.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/scanner/counter_random.h"
#include "engine/suggest/sample_zones.h"

namespace fettle::engine {
namespace {

constexpr std::int32_t kStepSide = 400;
constexpr double kSigma = 0.02;

Grid matchGrid(std::int32_t width = kStepSide, std::int32_t height = kStepSide) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  return grid;
}

// An edge along the middle column.
std::vector<SampleZone> zonesOfStep() {
  std::vector<float> z(static_cast<std::size_t>(kStepSide) * kStepSide);
  std::vector<std::uint8_t> marks(z.size());
  for (std::size_t r = 0; r < kStepSide; ++r) marks[r * kStepSide + kStepSide / 2] = 1;
  return zonesBesideMarks(makeField(matchGrid(), z, marks));
}

// A step of 1 there with noise, on each zone as many times kSigma.
std::vector<float> stepWithNoise(const std::vector<SampleZone>& zones, double flat, double edge,
                                 std::uint64_t seed) {
  const CounterRandom random(seed, 0);
  std::vector<float> z(zones.size());
  for (std::int32_t r = 0; r < kStepSide; ++r)
    for (std::int32_t c = 0; c < kStepSide; ++c) {
      const std::size_t i = static_cast<std::size_t>(r) * kStepSide + static_cast<std::size_t>(c);
      const double times = NoiseMatch{flat, edge}.in(zones[i]);
      z[i] = static_cast<float>((c < kStepSide / 2 ? 0.0 : 1.0) + times * kSigma * random.normal(c, r));
    }
  return z;
}

Version stepField(const std::vector<float>& z) {
  return makeField(matchGrid(), z);
}

TEST(SampleZones, AreByTheDistanceFromTheNextMark) {
  const std::vector<SampleZone> zones = zonesOfStep();
  const auto at = [&](int off) {
    return zones[static_cast<std::size_t>(100 * kStepSide + kStepSide / 2 + off)];
  };
  for (const int sign : {-1, 1}) {
    for (const int off : {0, 1, 3}) EXPECT_EQ(at(sign * off), SampleZone::kEdge) << off;
    for (const int off : {4, 8, 12}) EXPECT_EQ(at(sign * off), SampleZone::kBetween) << off;
    for (const int off : {13, 100}) EXPECT_EQ(at(sign * off), SampleZone::kFlat) << off;
  }
}

TEST(NoiseMatch, SaysWhatTheNoiseLacksInEachZone) {
  const auto zones = zonesOfStep();
  JobControl job;
  const auto match = matchNoise(stepField(stepWithNoise(zones, 1.0, 1.05, 1)),
                                stepField(stepWithNoise(zones, 0.97, 1.0, 2)), zones, kSigma, job);
  ASSERT_TRUE(match);
  // 149,600 and 2,800 samples: four standard errors of a ratio of two deviations.
  EXPECT_NEAR(match->flat, 1.0 / 0.97, 4.0 / std::sqrt(149600.0));
  EXPECT_NEAR(match->edge, 1.05, 4.0 / std::sqrt(2800.0));
  EXPECT_EQ(match->in(SampleZone::kBetween), 0.5 * (match->flat + match->edge));
}

// Texture that the sample has not is not noise for the most part.
TEST(NoiseMatch, IsBounded) {
  const auto zones = zonesOfStep();
  const Version quiet = stepField(stepWithNoise(zones, 1.0, 1.0, 1)),
                loud = stepField(stepWithNoise(zones, 1.6, 1.6, 2));
  JobControl job;
  const auto more = matchNoise(loud, quiet, zones, kSigma, job),
             less = matchNoise(quiet, loud, zones, kSigma, job);
  ASSERT_TRUE(more && less);
  EXPECT_EQ(more->flat, kMostMatched);
  EXPECT_EQ(more->edge, kMostMatched);
  EXPECT_EQ(less->flat, 1.0 / kMostMatched);
}

TEST(NoiseMatch, LeavesOutSpikesAndHoles) {
  const auto zones = zonesOfStep();
  std::vector<float> scan = stepWithNoise(zones, 1.0, 1.0, 1), sample = stepWithNoise(zones, 1.0, 1.0, 2);
  JobControl job;
  const auto plain = matchNoise(stepField(scan), stepField(sample), zones, kSigma, job);
  for (std::size_t i = 5000; i < scan.size(); i += 4999) scan[i] = 1e6F;
  for (std::size_t i = 0; i < 4000; ++i) sample[3 * i] = std::nanf("");
  const auto match = matchNoise(stepField(scan), stepField(sample), zones, kSigma, job);
  ASSERT_TRUE(plain && match);
  // What is in the window of a spike, a fifth of the field, loses a little more or less.
  EXPECT_NEAR(match->flat, plain->flat, 0.02);
  EXPECT_NEAR(match->edge, plain->edge, 0.04);
}

TEST(NoiseMatch, OfFewOrNoSamplesIsOne) {
  JobControl job;
  const std::vector<SampleZone> edge_alone(30, SampleZone::kEdge);
  for (const float height : {0.0F, std::nanf("")}) {
    const std::vector<float> z(30, height);
    const auto match =
        matchNoise(makeField(matchGrid(30, 1), z), makeField(matchGrid(30, 1), z), edge_alone, kSigma, job);
    ASSERT_TRUE(match);
    EXPECT_EQ(match->flat, 1.0);
    EXPECT_EQ(match->edge, 1.0);
  }
  // Without any noise in the sample no ratio is defined.
  const auto zones = zonesOfStep();
  const auto match = matchNoise(stepField(stepWithNoise(zones, 1.0, 1.0, 1)),
                                stepField(std::vector<float>(zones.size())), zones, kSigma, job);
  ASSERT_TRUE(match);
  EXPECT_EQ(match->flat, 1.0);
  EXPECT_EQ(match->edge, 1.0);
}

}  // namespace
}  // namespace fettle::engine
