#include "engine/uncertainty/part_effects.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/inspect/noise_model.h"
#include "engine/measure/form.h"
#include "engine/uncertainty/areal_figures.h"
#include "engine/uncertainty/extreme_trials.h"

namespace fettle::engine {
namespace {

constexpr int kWholeSide = 512;

Version fieldOf(const std::vector<float>& z, int width, int height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  return makeField(grid, z);
}

// Hills of some ten samples over steps that a part of one level would not have, with white noise.
std::vector<float> roughSteps(double sigma, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<float> z;
  for (int r = 0; r < kWholeSide; ++r)
    for (int c = 0; c < kWholeSide; ++c)
      z.push_back(static_cast<float>(
          (c / 128 % 2 == 0 ? 0.6 : -0.6) +
          0.6 * std::sin(0.61 * c + 0.3 * std::sin(0.05 * r)) * std::sin(0.53 * r) +
          0.4 * std::sin(0.23 * c + 0.37 * r) + (sigma > 0.0 ? sigma * normal(random) : 0.0)));
  return z;
}

Result<Version> planeOut(const Version& field) {
  JobControl job;
  const auto fit = fitForm(field, {}, job);
  if (!fit) return tl::unexpected(fit.error());
  return withoutForm(field, fit->form, job);
}

Result<ArealParameters> parametersOf(const Version& field, TrialNoise = TrialNoise::kOwn) {
  JobControl job;
  const auto fit = fitForm(field, {}, job);
  if (!fit) return tl::unexpected(fit.error());
  return measureAreal(field, fit->form, {}, job);
}

NoiseModel whiteNoise(double sigma) {
  NoiseModel model;
  model.sigma = sigma;
  model.parts.uncorrelated = sigma * sigma;
  return model;
}

TEST(StandingPart, HasASquareInEachPartOfTheField) {
  const PartOptions options{.side = 40, .squares = 4};
  for (const auto& [width, height] : {std::pair(512, 512), {5000, 70}, {20000, 1}, {41, 90000}, {30, 30}}) {
    Grid grid;
    grid.width = width;
    grid.height = height;
    const auto squares = standingSquares(grid, options);
    ASSERT_FALSE(squares.empty());
    EXPECT_LE(squares.size(), 16U);
    if (std::int64_t{width} * height > 64000) {
      EXPECT_GE(squares.size(), 11U) << width << "x" << height;
    }
    std::set<std::pair<int, int>> parts;
    for (const SampleRect& r : squares) {
      EXPECT_GE(r.column, 0);
      EXPECT_GE(r.row, 0);
      EXPECT_LE(r.column + r.columns, width);
      EXPECT_LE(r.row + r.rows, height);
      EXPECT_LE(std::int64_t{r.columns} * r.rows, 1600);
      EXPECT_EQ(std::int64_t{r.columns} * r.rows, squares.front().columns * squares.front().rows);
      parts.insert({r.column, r.row});
    }
    EXPECT_EQ(parts.size(), squares.size()) << "no square twice";
  }
}

TEST(StandingPart, SquaresLieBesideEachOtherWithHolesBetween) {
  std::vector<Version> squares;
  for (int k = 0; k < 6; ++k) squares.push_back(fieldOf(std::vector<float>(20, static_cast<float>(k)), 5, 4));
  const Version part = besideEachOther(squares, 3);
  EXPECT_EQ(part.grid().width, 3 * 5 + 2 * 3);
  EXPECT_EQ(part.grid().height, 2 * 4 + 3);
  std::vector<int> seen(6);
  for (int r = 0; r < part.grid().height; ++r)
    for (int c = 0; c < part.grid().width; ++c) {
      const float z = part.reader().heightAt(c, r);
      if (std::isnan(z)) continue;
      ++seen[static_cast<std::size_t>(z)];
      EXPECT_EQ(static_cast<int>(z), r / 7 * 3 + c / 8);
    }
  EXPECT_EQ(seen, std::vector<int>(6, 20));
}

// The greatest of n normal deviates, by drawing all n: means of 4,000 trials are known to 0.6 / 63 of a deviation.
TEST(ExtremeTail, MovesAsTheGreatestOfAllSamplesWouldMove) {
  for (const int n : {1, 10, 1000}) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    std::vector<float> z;
    for (int i = 0; i < n; ++i) z.push_back(static_cast<float>(2.0 + 0.3 * (i % 7)));
    const ExtremeTail tail(fieldOf(z, n, 1), ExtremeTail::End::kHighest, 0.5);
    const ExtremeTail low(fieldOf(z, n, 1), ExtremeTail::End::kLowest, 0.5);
    const double top = *std::max_element(z.begin(), z.end());
    double drawn = 0.0, all = 0.0, lowest = 0.0, opposite = 0.0;
    constexpr int kTrials = 4000;
    for (int k = 0; k < kTrials; ++k) {
      const TrialPair pair = tail.drawn(random);
      drawn += 0.5 * (pair.more + pair.less) / kTrials;
      opposite += pair.more * pair.less / kTrials;
      lowest += low.drawn(random).more / kTrials;
      double greatest = -1e9;
      for (const float height : z) greatest = std::max(greatest, height + 0.5 * normal(random));
      all += (greatest - top) / kTrials;
    }
    EXPECT_NEAR(drawn, all, 0.035) << n;
    // From below the same heights in another order: as far.
    EXPECT_GT(lowest, n == 1 ? -0.04 : 0.05) << n;
    if (n == 1) {
      EXPECT_NEAR(opposite, -0.25, 0.03) << "of one sample a noise and its opposite";
    }
  }
  const ExtremeTail none(fieldOf({std::numeric_limits<float>::quiet_NaN()}, 1, 1), ExtremeTail::End::kHighest,
                         1.0);
  std::mt19937_64 random(1);
  EXPECT_EQ(none.drawn(random).more, 0.0);
}

// A spike moves by its own noise alone, whatever lies below it.
TEST(ExtremeTail, ASpikeMovesByItsOwnNoise) {
  std::vector<float> z(10000, 0.0F);
  z[777] = 1e6F;
  const ExtremeTail tail(fieldOf(z, 100, 100), ExtremeTail::End::kHighest, 0.5);
  std::mt19937_64 random(5);
  double square = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const TrialPair pair = tail.drawn(random);
    EXPECT_EQ(pair.more, -pair.less);
    square += pair.more * pair.more / 2000;
  }
  EXPECT_NEAR(square, 0.25, 0.03);  // 0.25 (1 +- 3 sqrt(2 / 2000))
}

struct Sums {
  int stated = 0, within[3] = {}, of_whole = 0, alike = 0;
};

// Against the truth, and against trials on the whole field, whose part has a fifth of the samples. The noise is given, as its
// estimate is not what is in question.
TEST(PartEffects, CoverTheTruthAsTrialsOnTheWholeDo) {
  constexpr int kSeeds = 3;
  const double sigma = 0.08;
  const auto truth = valuesOf(*parametersOf(fieldOf(roughSteps(0.0, 0), kWholeSide, kWholeSide)));
  Sums sums;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    JobControl job;
    const Version field = fieldOf(roughSteps(sigma, seed), kWholeSide, kWholeSide);
    const NoiseModel noise = whiteNoise(sigma);
    const auto measured = parametersOf(field);
    const auto surface = planeOut(field);
    ASSERT_TRUE(measured && surface);
    const auto part = arealEffectsOfPart(field, noise, *surface, *measured, {}, planeOut,
                                         {.side = 64, .squares = 4, .pairs = 4, .seed = seed}, job);
    ASSERT_TRUE(part) << part.error().line();
    EXPECT_EQ(part->samples, 16 * 64 * 64);
    const auto whole =
        arealEffects(field, noise, *measured, parametersOf, {.pairs = 4, .seed = seed + 100U}, job);
    ASSERT_TRUE(whole);
    const std::vector<double> found = valuesOf(*measured);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const NoiseEffect &by_part = part->effects[i], &by_whole = (*whole)[i];
      if (std::isnan(by_whole.error)) continue;
      ++sums.of_whole;
      if (std::isnan(by_part.error)) continue;
      ++sums.stated;
      const double off = std::abs(by_part.without - truth[i]);
      for (int k = 0; k < 3; ++k) sums.within[k] += off <= (k + 1) * by_part.error;
      // Both say the same of the surface without noise, within their errors together.
      sums.alike +=
          std::abs(by_part.without - by_whole.without) <= 3.0 * std::hypot(by_part.error, by_whole.error);
      fmt::print("{:6} truth {:9.4g} found {:9.4g} part {:9.4g} +- {:8.2g}, whole {:9.4g} +- {:8.2g}\n",
                 arealFigures()[i].key, truth[i], found[i], by_part.without, by_part.error, by_whole.without,
                 by_whole.error);
    }
  }
  fmt::print("{} of {} stated: {} {} {}, alike {}\n", sums.stated, sums.of_whole, sums.within[0],
             sums.within[1], sums.within[2], sums.alike);
  EXPECT_GE(sums.stated, 0.8 * sums.of_whole);
  // As ArealNoise demands of trials on the whole: figures of one scan go together.
  EXPECT_GE(sums.within[0], 0.55 * sums.stated);
  EXPECT_GE(sums.within[1], 0.82 * sums.stated);
  EXPECT_GE(sums.within[2], 0.90 * sums.stated);
  EXPECT_GE(sums.alike, 0.95 * sums.stated);
}

TEST(PartEffects, WhatHasNoSamplesHasNoEffect) {
  JobControl job;
  const Version holes =
      fieldOf(std::vector<float>(300 * 300, std::numeric_limits<float>::quiet_NaN()), 300, 300);
  ArealParameters none;
  const auto part = arealEffectsOfPart(
      holes, whiteNoise(0.1), holes, none, {},
      [](const Version&) -> Result<Version> { return inputError("no sample", "form"); }, {.side = 40}, job);
  ASSERT_TRUE(part);
  EXPECT_EQ(part->samples, 0);
  for (const NoiseEffect& effect : part->effects) EXPECT_TRUE(std::isnan(effect.error));
}

// The surface as it is, and a noise that the map makes twice as large on one half: the mean square is that of both.
TEST(PartEffects, NoiseIsAsLargeAsItsMapSays) {
  JobControl job;
  NoiseModel noise = whiteNoise(0.1);
  noise.map.assign(NoiseModel::kMapSide * NoiseModel::kMapSide, 0.1);
  for (std::size_t i = 0; i < noise.map.size(); ++i)
    if (i % NoiseModel::kMapSide >= NoiseModel::kMapSide / 2) noise.map[i] = 0.3;
  const Version field = fieldOf(roughSteps(0.0, 0), kWholeSide, kWholeSide);
  const auto measured = parametersOf(field);
  const auto surface = planeOut(field);
  ASSERT_TRUE(measured && surface);
  const auto part = arealEffectsOfPart(field, noise, *surface, *measured,
                                       {.hybrid = false, .spatial = false, .feature = false}, planeOut,
                                       {.side = 64, .pairs = 4}, job);
  ASSERT_TRUE(part);
  // Sq^2 less the raise, half of 0.01 and half of 0.09.
  const double square = measured->sq * measured->sq - 0.05;
  EXPECT_NEAR(part->effects[0].without, std::sqrt(square), 0.004);
}

}  // namespace
}  // namespace fettle::engine
