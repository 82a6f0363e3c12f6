#include "engine/uncertainty/noise_trial.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "engine/field/builder.h"
#include "engine/uncertainty/areal_figures.h"

namespace fettle::engine {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Version plateOf(std::int32_t width, std::int32_t height, double hole_share = 0.0) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform;
  std::vector<float> z;
  for (int i = 0; i < width * height; ++i)
    z.push_back(uniform(random) < hole_share ? std::numeric_limits<float>::quiet_NaN()
                                             : static_cast<float>(5e6 + 1e-3 * i));
  return makeField(grid, z, {});
}

NoiseModel whiteOf(double sigma) {
  NoiseModel model;
  model.sigma = sigma;
  model.parts.uncorrelated = sigma * sigma;
  return model;
}

std::vector<float> heightsOf(const Version& field) {
  const Grid& grid = field.grid();
  std::vector<float> z(static_cast<std::size_t>(grid.samples()));
  field.reader().readHeights(0, 0, grid.width, grid.height, z.data(), grid.width);
  return z;
}

Result<Version> withNoise(const Version& field, const NoiseModel& noise, std::uint64_t seed, double sign,
                          JobControl& job) {
  const auto draw = NoiseDraw::create(field.grid(), noise, seed);
  if (!draw) return tl::unexpected(draw.error());
  return draw->addedTo(field, noise, sign, job);
}

TEST(NoiseTrial, NoiseAndItsOppositeAreAddedAndHolesStay) {
  const Version field = plateOf(100, 80, 0.1);
  JobControl job;
  const auto more = withNoise(field, whiteOf(20.0), 3, 1.0, job),
             less = withNoise(field, whiteOf(20.0), 3, -1.0, job);
  ASSERT_TRUE(more && less);
  const std::vector<float> z = heightsOf(field), a = heightsOf(*more), b = heightsOf(*less);
  double squares = 0.0;
  int n = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    EXPECT_EQ(std::isnan(a[i]), std::isnan(z[i]));
    if (std::isnan(z[i])) continue;
    // Heights of 5e6 are stored to 0.5: half of that each.
    EXPECT_NEAR(static_cast<double>(a[i]) - z[i], -(static_cast<double>(b[i]) - z[i]), 1.0);
    squares += std::pow(static_cast<double>(a[i]) - z[i], 2);
    ++n;
  }
  // The root of a mean of 7,200 squares is within 4 / sqrt(2 n) of 20.
  EXPECT_NEAR(std::sqrt(squares / n), 20.0, 20.0 * 4.0 / std::sqrt(2.0 * n));
  // As large as the map says at each place.
  NoiseModel louder = whiteOf(20.0);
  louder.map.assign(NoiseModel::kMapSide * NoiseModel::kMapSide, 40.0);
  const auto twice = withNoise(field, louder, 3, 1.0, job);
  ASSERT_TRUE(twice);
  const std::vector<float> t = heightsOf(*twice);
  for (std::size_t i = 0; i < z.size(); ++i)
    if (!std::isnan(z[i])) {
      EXPECT_NEAR(t[i] - z[i], 2.0 * (static_cast<double>(a[i]) - z[i]), 1.5);
    }
}

TEST(NoiseTrial, IsTheSameForAnyNumberOfThreads) {
  const Version field = plateOf(150, 90);
  const auto noisy = [&](int threads) {
    tbb::task_arena arena(threads);
    return arena.execute([&] {
      JobControl job;
      return heightsOf(*withNoise(field, whiteOf(3.0), 9, 1.0, job));
    });
  };
  EXPECT_EQ(noisy(1), noisy(4));
}

// Closed forms: figures that follow the noise exactly as their growth says.
TEST(NoiseTrial, UndoesTheRaiseOfWhatGrowsAsStated) {
  // A square: sqrt(S^2 + v) with v = 1 found and v = 2 in trials.
  std::vector<TrialPair> pairs;
  for (const double d : {0.05, -0.02, 0.01, -0.04})
    pairs.push_back({std::sqrt(9.0 + 2.0 + d), std::sqrt(9.0 + 2.0 - d)});
  const NoiseEffect square = noiseEffectOf(std::sqrt(10.0), pairs, NoiseGrowth::kSquare);
  EXPECT_NEAR(square.without, 3.0, 1e-12);
  // Halves of the squares' differences: their root mean square, and 0.2 of the raise of 1.
  const double scatter = studentFactor(4) * std::sqrt((25.0 + 4.0 + 1.0 + 16.0) / 4.0) * 1e-2;
  EXPECT_NEAR(square.error, std::hypot(scatter, 0.2) / 6.0, 3e-4);
  pairs = {{5.5, 4.5}, {4.0, 6.0}, {5.0, 5.0}};
  const NoiseEffect plain = noiseEffectOf(4.0, pairs, NoiseGrowth::kPlain);
  EXPECT_NEAR(plain.without, 3.0, 1e-12);
  EXPECT_NEAR(plain.error, std::hypot(studentFactor(3) * std::sqrt((0.25 + 1.0) / 3.0), 0.2), 1e-12);
  // Half a turn is 0 again.
  const std::vector<TrialPair> axes = {{179.0, 1.0}, {1.0, 179.0}};
  const NoiseEffect axis = noiseEffectOf(0.5, axes, NoiseGrowth::kAxis);
  EXPECT_NEAR(axis.without, 1.0, 1e-9);
  EXPECT_LT(axis.error, 2.0);
}

// The same noise with twice its variance says how a figure bends: a parabola in the variance is undone exactly, and of what grows in
// proportion no share is in doubt but the noise's own.
TEST(NoiseTrial, UndoesTheBendThatLouderNoiseShows) {
  const auto parabola = [](double variance) { return 2.0 + 0.5 * variance + 0.1 * variance * variance; };
  const double found = parabola(1.0), twice = parabola(2.0), thrice = parabola(3.0);
  const std::vector<TrialPair> pairs(4, {twice, twice});
  const NoiseEffect curved =
      noiseEffectOf(found, pairs, NoiseGrowth::kCurved, {.doubt = 0.01, .louder = {thrice, thrice}});
  EXPECT_NEAR(curved.without, 2.0, 1e-12);
  const double raise = twice - found, bend = thrice - 2.0 * twice + found;
  EXPECT_NEAR(curved.error, std::hypot(0.01 * raise, 0.3 * bend), 1e-12);
  // Heights whose squares grow with the noise's: no bend.
  const std::vector<TrialPair> squares(4, {std::sqrt(11.0), std::sqrt(11.0)});
  const NoiseEffect square = noiseEffectOf(std::sqrt(10.0), squares, NoiseGrowth::kSquare,
                                           {.doubt = 0.01, .louder = {std::sqrt(12.0), std::sqrt(12.0)}});
  EXPECT_NEAR(square.without, 3.0, 1e-12);
  EXPECT_NEAR(square.error, 0.01 / 6.0, 1e-5);
  // Ranks keep the straight line, and the bend counts as what that leaves open.
  const NoiseEffect rank =
      noiseEffectOf(found, pairs, NoiseGrowth::kShare, {.doubt = 0.0, .louder = {thrice, thrice}});
  EXPECT_NEAR(rank.without, found - raise, 1e-12);
  EXPECT_NEAR(rank.error, std::hypot(0.25 * raise, 2.5 * bend), 1e-12);
}

// Quantiles of Student's distribution at 68.27 %, of a table, and the standard deviation of the root of a mean of n squares by simulation.
TEST(NoiseTrial, AFewPairsWidenTheirErrorAndSayHowSureItIs) {
  EXPECT_NEAR(studentFactor(2), 1.321, 0.01);
  EXPECT_NEAR(studentFactor(4), 1.142, 0.002);
  EXPECT_NEAR(studentFactor(8), 1.067, 0.001);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (const int pairs : {2, 4, 8, 16}) {
    constexpr int kDraws = 20000;
    double sum = 0.0, squares = 0.0;
    int within = 0;
    for (int i = 0; i < kDraws; ++i) {
      std::vector<TrialPair> drawn;
      for (int k = 0; k < pairs; ++k) {
        const double z = normal(random);
        drawn.push_back({10.0 + z, 10.0 - z});
      }
      const double error = noiseEffectOf(10.0, drawn, NoiseGrowth::kPlain).error / studentFactor(pairs);
      sum += error;
      squares += error * error;
      within += std::abs(normal(random)) <= error * studentFactor(pairs) ? 1 : 0;
    }
    const double mean = sum / kDraws, scatter = std::sqrt(squares / kDraws - mean * mean);
    // 1 / sqrt(2 n) is that of many; of two 0.463 instead of 0.5.
    EXPECT_NEAR(scatter, errorOfErrors(pairs), 0.04) << pairs;
    // Four standard deviations of the share.
    EXPECT_NEAR(within / double(kDraws), 0.6827, 4.0 * std::sqrt(0.22 / kDraws) + 0.003) << pairs;
  }
}

TEST(NoiseTrial, SaysNothingOfWhatItCannotDecide) {
  const std::vector<TrialPair> same(4, {2.0, 2.0});
  EXPECT_EQ(noiseEffectOf(2.0, same, NoiseGrowth::kPlaces).error, 0.0);
  EXPECT_TRUE(std::isnan(noiseEffectOf(kNone, same, NoiseGrowth::kSquare).error));
  const std::vector<TrialPair> half = {{2.0, 2.0}, {kNone, 2.0}, {2.0, 2.0}, {2.0, kNone}};
  EXPECT_TRUE(std::isnan(noiseEffectOf(2.0, half, NoiseGrowth::kPlain).without));
  // All of it is noise: 0, and an error that reaches to what it may be.
  const std::vector<TrialPair> all(4, {2.0, 2.0});
  const NoiseEffect none = noiseEffectOf(1.2, all, NoiseGrowth::kSquare);
  EXPECT_EQ(none.without, 0.0);
  EXPECT_GT(none.error, 0.0);
  EXPECT_LT(none.error, 1.2);
  // Peaks that noise raises by more than a fifth.
  EXPECT_TRUE(std::isnan(noiseEffectOf(1.6, all, NoiseGrowth::kPlaces).error));
}

// Hard cases have a figure or none, never half of one.
TEST(NoiseTrial, OfOneRowAFlatPlateAndSpikesIsFiniteOrNone) {
  JobControl job;
  for (const Version& field : {plateOf(40, 1), plateOf(1, 1), plateOf(30, 30, 0.9)}) {
    const auto measure = [](const Version& of, TrialNoise) -> Result<ArealParameters> {
      JobControl own;
      const auto fit = fitForm(of, {}, own);
      if (!fit) return tl::unexpected(fit.error());
      return measureAreal(of, fit->form, {}, own);
    };
    const auto measured = measure(field, TrialNoise::kOwn);
    ASSERT_TRUE(measured);
    const auto effects = arealEffects(field, whiteOf(0.5), *measured, measure, {.pairs = 2}, job);
    ASSERT_TRUE(effects) << effects.error().line();
    EXPECT_EQ(effects->size(), arealFigures().size());
    for (const NoiseEffect& effect : *effects) {
      EXPECT_EQ(std::isnan(effect.without), std::isnan(effect.error));
      if (!std::isnan(effect.error)) {
        EXPECT_TRUE(std::isfinite(effect.error) && effect.error >= 0.0);
      }
    }
  }
  JobControl cancelled;
  cancelled.cancel();
  EXPECT_FALSE(withNoise(plateOf(40, 40), whiteOf(1.0), 1, 1.0, cancelled));
}

TEST(NoiseTrial, AnErrorThatLeavesAFigureOpenIsNone) {
  const FigureRange share{0.0, 1.0}, size{.low = 0.0}, angle{0.0, 180.0};
  // Smrk1 +- 2.9e17 %, Smrk2 90 +- 180 %, an angle +- 3e5 degrees.
  for (const NoiseEffect& effect :
       {withinRange({0.1, 2.9e15}, 0.1, share), withinRange({0.9, 1.8}, 0.9, share),
        withinRange({30.0, 3e5}, 31.0, angle), withinRange({0.2, 1.1}, 1.0, size),
        withinRange({0.5, std::numeric_limits<double>::infinity()}, 0.5, {})}) {
    EXPECT_TRUE(std::isnan(effect.without) && std::isnan(effect.error));
    EXPECT_FALSE(effect.why.empty());
  }
  const NoiseEffect usual = withinRange({0.9, 0.02}, 0.88, share);
  EXPECT_EQ(usual.without, 0.9);
  EXPECT_EQ(usual.error, 0.02);
  EXPECT_EQ(usual.why, "");
  // All of Sdr may be noise: 0 is then as near as the error; far below it is no figure.
  EXPECT_EQ(withinRange({-0.01, 0.02}, 0.05, size).without, 0.0);
  EXPECT_EQ(withinRange({-0.01, 0.02}, 0.05, size).error, 0.02);
  EXPECT_TRUE(std::isnan(withinRange({-0.05, 0.02}, 0.05, size).without));
  EXPECT_EQ(withinRange({1.01, 0.02}, 0.99, share).without, 1.0);
  // Skewness has any value.
  EXPECT_EQ(withinRange({-3.0, 4.0}, 0.5, {}).error, 4.0);
}

TEST(NoiseTrial, ParametersUnderMuchNoiseStayWithinTheirRanges) {
  const Version field = [] {
    Grid grid;
    grid.width = 64;
    grid.height = 48;
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    std::vector<float> z;
    for (int i = 0; i < 64 * 48; ++i) z.push_back(static_cast<float>(1e-3 * normal(random)));
    return makeField(grid, z, {});
  }();
  JobControl job;
  const auto measure = [&](const Version& of, TrialNoise = TrialNoise::kOwn) -> Result<ArealParameters> {
    return measureAreal(of, PolynomialForm{0, 64, 48, 0.0, {0.0}}, {.spatial = false}, job);
  };
  const auto measured = measure(field);
  ASSERT_TRUE(measured);
  // A hundred times the noise that there is.
  const auto effects = arealEffects(field, whiteOf(0.1), *measured, measure, {.pairs = 2}, job);
  ASSERT_TRUE(effects);
  for (std::size_t i = 0; i < arealFigures().size(); ++i) {
    const auto& [key, of, growth, range] = arealFigures()[i];
    const NoiseEffect& effect = (*effects)[i];
    if (std::isnan(effect.without)) continue;
    EXPECT_GE(effect.without, range.low) << key;
    EXPECT_LE(effect.without, range.high) << key;
    EXPECT_LE(effect.error, range.high - range.low) << key;
  }
  const auto smrk1 = static_cast<std::size_t>(&arealFigure("smrk1") - arealFigures().data());
  EXPECT_FALSE((*effects)[smrk1].why.empty());
}

// Noise that makes other hills than there are says nothing of their sizes; of dales it may.
TEST(NoiseTrial, SizesOfHillsAreNoneWhereTheirNumberIsOpen) {
  ArealParameters measured;
  measured.feature.spd = measured.feature.svd = 1.0;
  measured.feature.sha = measured.feature.sda = measured.feature.shv = measured.feature.sdv = 2.0;
  const auto indexOf = [](std::string_view key) {
    return static_cast<std::size_t>(&arealFigure(key) - arealFigures().data());
  };
  std::vector<NoiseEffect> effects;
  for (const double found : valuesOf(measured)) effects.push_back({found, 0.01 * found});
  effects[indexOf("spd")] = {std::nan(""), std::nan(""), "noise changes it by more than a fifth"};
  keepWithinRanges(effects, measured);
  for (const char* const key : {"sha", "shv"}) {
    EXPECT_TRUE(std::isnan(effects[indexOf(key)].without)) << key;
    EXPECT_FALSE(effects[indexOf(key)].why.empty()) << key;
  }
  for (const char* const key : {"sda", "sdv"}) EXPECT_EQ(effects[indexOf(key)].without, 2.0) << key;
}

}  // namespace
}  // namespace fettle::engine
