#include "engine/uncertainty/roughness_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/measure/section.h"

namespace fettle::engine {
namespace {

using std::numbers::pi;
constexpr int kColumns = 300, kRows = 40;

// Ground along x: waves of 9, 23 and 61 samples, mean square about 1.
Version groundField(double sigma, unsigned seed) {
  Grid grid;
  grid.width = kColumns;
  grid.height = kRows;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, sigma);
  std::vector<float> z;
  for (int r = 0; r < kRows; ++r)
    for (int c = 0; c < kColumns; ++c)
      z.push_back(
          static_cast<float>(0.5 * std::sin(2.0 * pi * c / 9.0) + std::sin(2.0 * pi * c / 23.0 + 1.0) +
                             0.8 * std::sin(2.0 * pi * c / 61.0) + (sigma > 0.0 ? normal(random) : 0.0)));
  return makeField(grid, z, {});
}

Section sectionOf(const Version& field, double to_y, double width) {
  JobControl job;
  SectionOptions options;
  options.width_mm = width;
  const std::vector<glm::dvec2> line = {{2.0, 12.0}, {290.0, to_y}};
  const auto section = sectionAlong(field, line, options, job);
  EXPECT_TRUE(section) << section.error().line();
  return *section;
}

// The noise that is drawn has the covariance of the section, at every lag of its band, and none beyond.
TEST(SectionNoise, HasTheCovarianceOfTheSection) {
  const Section section = sectionOf(groundField(0.0, 1), 30.0, 3.0);
  ASSERT_GT(section.band, 2);
  const std::size_t n = section.size(), band = static_cast<std::size_t>(section.band);
  constexpr int kDraws = 400;
  std::vector<double> sums(band + 2), wanted(band + 2);
  for (const std::vector<double>& noise : sectionNoise(section, {0.3}, 0, kDraws)) {
    ASSERT_EQ(noise.size(), n);
    for (std::size_t i = 0; i + band + 2 < n; ++i)
      for (std::size_t lag = 0; lag < band + 2; ++lag) sums[lag] += noise[i] * noise[i + lag] / kDraws;
  }
  for (std::size_t i = 0; i + band + 2 < n; ++i)
    for (std::size_t lag = 0; lag < band; ++lag) wanted[lag] += 0.09 * section.covariance[i * band + lag];
  // A mean over 400 x 280 products of unit variance, neighbours of which are alike: 0.3 % times a few, of the variance.
  for (std::size_t lag = 0; lag < band + 2; ++lag)
    EXPECT_NEAR(sums[lag], wanted[lag], 0.02 * wanted[0]) << lag;
}

struct Shares {
  int n = 0, within[3] = {};
};

// Of simulated scans: how often the parameters of the surface's profile lie within 1, 2 and 3 errors.
void expectCoverage(ProfileKind kind, int few) {
  const char* const typed = std::getenv("FETTLE_NOISE_SEEDS");
  const int seeds = typed == nullptr ? few : std::atoi(typed);
  const std::span<const RoughnessInfo> infos = roughnessInfos();
  Shares together;
  for (const auto& [sigma, to_y, width] :
       {std::tuple(0.02, 12.0, 0.0), {0.1, 12.0, 0.0}, {0.1, 30.0, 0.0}, {0.1, 30.0, 3.0}}) {
    const Section clean = sectionOf(groundField(0.0, 1), to_y, width);
    const Stretch all{0.0, clean.lengthMm()};
    // Waves of 9 and 23 samples pass waviness, and fill five lengths of roughness.
    const ProfileFilters filters{kind == ProfileKind::kWaviness ? 8.0 : 40.0, 0.0, kind};
    const auto truth = roughnessOf(clean, all, filters);
    ASSERT_TRUE(truth);
    std::vector<Shares> shares(infos.size());
    for (int s = 0; s < seeds; ++s) {
      const Section noisy = sectionOf(groundField(sigma, 100U + static_cast<unsigned>(s)), to_y, width);
      const auto found = roughnessOf(noisy, all, filters);
      ASSERT_TRUE(found);
      const auto noise = roughnessNoise(noisy, all, filters, *found, {sigma},
                                        {.pairs = 16, .seed = 5000 + 100 * static_cast<std::uint64_t>(s)});
      ASSERT_TRUE(noise);
      for (std::size_t f = 0; f < infos.size(); ++f) {
        const NoiseEffect& effect = (*noise)[f];
        if (std::isnan(effect.error)) continue;
        ++shares[f].n;
        for (int k = 0; k < 3; ++k)
          shares[f].within[k] +=
              std::abs(effect.without - (*truth).*infos[f].figure) <= (k + 1) * effect.error ? 1 : 0;
      }
    }
    for (std::size_t f = 0; f < infos.size(); ++f) {
      const Shares& of = shares[f];
      const std::string name =
          fmt::format("{} {}, noise {}, to {}, width {}: {} {} {} of {}", profileInfo(kind).word,
                      infos[f].symbol, sigma, to_y, width, of.within[0], of.within[1], of.within[2], of.n);
      fmt::print("{}\n", name);
      together.n += of.n;
      for (int k = 0; k < 3; ++k) together.within[k] += of.within[k];
      if (kind != ProfileKind::kRoughness) continue;
      // Not of scans in which noise happens to split elements.
      if (infos[f].figure != &Roughness::rc) {
        EXPECT_GE(of.n, 0.95 * seeds) << name;
      }
      // Of 40 draws with a chance of 0.68, 0.95: 3.5 standard deviations below, and 1 in 1,000.
      EXPECT_GE(of.within[0], 0.42 * of.n) << name;
      EXPECT_GE(of.within[1], 0.80 * of.n) << name;
      EXPECT_GE(of.within[2], 0.90 * of.n) << name;
    }
  }
  fmt::print("{} together {}: {} {} {}\n", profileInfo(kind).word, together.n, together.within[0],
             together.within[1], together.within[2]);
  // Of few waves the mean width and height of elements jump where one of them falls below the threshold: figures are taken together.
  EXPECT_GE(together.n, 0.95 * 4 * 10 * seeds) << "those of waviness that are stated, without Rc";
  EXPECT_GE(together.within[0], 0.60 * together.n);
  EXPECT_GE(together.within[1], 0.88 * together.n);
  EXPECT_GE(together.within[2], 0.95 * together.n);
}

TEST(RoughnessNoise, ErrorsCoverTheTruthOfAKnownProfile) {
  expectCoverage(ProfileKind::kRoughness, 40);
}
TEST(RoughnessNoise, ErrorsCoverTheTruthOfItsPrimaryProfile) {
  expectCoverage(ProfileKind::kPrimary, 40);
}
TEST(RoughnessNoise, ErrorsCoverTheTruthOfItsWaviness) {
  expectCoverage(ProfileKind::kWaviness, 40);
}

// A sine has no peaks over its core: what trials make of their share lies below 0, and its error leaves it open.
TEST(RoughnessNoise, FiguresWithoutNoiseLieWithinTheirRange) {
  Grid grid;
  grid.width = 1000;
  grid.height = 20;
  grid.spacing_x = grid.spacing_y = 0.01;
  bool any = false;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal(0.0, 1e-4);
    std::vector<float> z;
    for (int r = 0; r < grid.height; ++r)
      for (int c = 0; c < grid.width; ++c)
        z.push_back(static_cast<float>(0.01 * std::sin(2.0 * pi * c / 50.0) + normal(random)));
    JobControl job;
    const std::vector<glm::dvec2> line = {{3.05, 0.1}, {9.99, 0.1}};
    const auto section = sectionAlong(makeField(grid, z), line, {}, job);
    ASSERT_TRUE(section);
    const Stretch all{0.0, section->lengthMm()};
    const auto found = roughnessOf(*section, all, {1.0});
    ASSERT_TRUE(found);
    const auto noise = roughnessNoise(*section, all, {1.0}, *found, {1e-4}, {.pairs = 32});
    ASSERT_TRUE(noise);
    for (std::size_t f = 0; f < noise->size(); ++f) {
      const NoiseEffect& effect = (*noise)[f];
      const RoughnessInfo& info = roughnessInfos()[f];
      if (std::isnan(effect.without) || info.figure == &Roughness::rsk) continue;
      any = true;
      EXPECT_GE(effect.without, 0.0) << info.symbol << " seed " << seed;
      if (info.unit == RoughnessInfo::Unit::kRatio)
        EXPECT_LE(effect.without, 1.0) << info.symbol;
      else
        EXPECT_LE(effect.error, std::max(found.value().*info.figure, effect.without)) << info.symbol;
    }
  }
  EXPECT_TRUE(any);
}

TEST(RoughnessNoise, WithoutNoiseHasNoEffect) {
  const Section section = sectionOf(groundField(0.1, 3), 12.0, 0.0);
  const Stretch all{0.0, section.lengthMm()};
  const auto found = roughnessOf(section, all, {40.0});
  ASSERT_TRUE(found);
  for (const double none : {0.0, std::nan("")}) {
    const auto noise = roughnessNoise(section, all, {40.0}, *found, {none}, {});
    ASSERT_TRUE(noise);
    for (const NoiseEffect& effect : *noise) EXPECT_TRUE(std::isnan(effect.error));
  }
}

// A random profile of smooth hills: noise splits them, so that Rc is that of others. What is stated is within three errors of the surface's, and of much noise
// nothing is.
TEST(RoughnessNoise, RcIsStatedWhereNoiseLeavesTheElementsAsTheyAre) {
  constexpr int kPlaces = 600, kReach = 40;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> white, profile;
  for (int c = 0; c < kPlaces + 2 * kReach; ++c) white.push_back(normal(random));
  for (int c = 0; c < kPlaces; ++c) {
    double sum = 0.0;
    for (int k = 0; k <= 2 * kReach; ++k)
      sum += std::exp(-0.005 * (k - kReach) * (k - kReach)) * white[static_cast<std::size_t>(c + k)];
    profile.push_back(sum / std::sqrt(17.7));  // the sum of squared weights
  }
  const auto section = [&](double sigma, unsigned seed) {
    Grid grid;
    grid.width = kPlaces;
    grid.height = 6;
    std::mt19937_64 own(seed);
    std::vector<float> z;
    for (int r = 0; r < grid.height; ++r)
      for (const double height : profile) z.push_back(static_cast<float>(height + sigma * normal(own)));
    JobControl job;
    const std::vector<glm::dvec2> line = {{2.0, 3.0}, {596.0, 3.0}};
    return *sectionAlong(makeField(grid, z, {}), line, {}, job);
  };
  const Section clean = section(0.0, 1);
  const Stretch all{0.0, clean.lengthMm()};
  const ProfileFilters filters{100.0};
  const Roughness truth = *roughnessOf(clean, all, filters);
  const std::span<const RoughnessInfo> infos = roughnessInfos();
  const auto rc = static_cast<std::size_t>(std::ranges::find(infos, &Roughness::rc, &RoughnessInfo::figure) -
                                           infos.begin());
  constexpr unsigned kSeeds = 20;
  for (const double sigma : {0.005, 0.02, 0.05, 0.2}) {
    int stated = 0, within = 0;
    for (unsigned seed = 0; seed < kSeeds; ++seed) {
      const Section noisy = section(sigma, 100 + seed);
      const Roughness found = *roughnessOf(noisy, all, filters);
      const NoiseEffect effect =
          (*roughnessNoise(noisy, all, filters, found, {sigma}, {.pairs = 16, .seed = 70 + 100U * seed}))[rc];
      if (std::isnan(effect.without)) {
        EXPECT_FALSE(effect.why.empty());
        continue;
      }
      ++stated;
      within += std::abs(effect.without - truth.rc) <= 3.0 * effect.error ? 1 : 0;
    }
    fmt::print("noise {}: Rc stated of {}, {} within three errors\n", sigma, stated, within);
    EXPECT_GE(within, 0.9 * stated) << sigma;
    if (sigma < 0.01) {
      EXPECT_GT(stated, 15);
    }
    if (sigma > 0.1) {
      EXPECT_EQ(stated, 0);
    }
  }
}

}  // namespace
}  // namespace fettle::engine
