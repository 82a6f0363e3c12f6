// Errors by noise of what is asked of the material ratio curve of a profile: Rmr(c) and Rdc.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/uncertainty/roughness_noise.h"

namespace fettle::engine {
namespace {

using std::numbers::pi;

constexpr std::size_t kProfilePlaces = 900;

struct KnownProfile {
  const char* name;
  double (*height)(double place);
};
// Of a mean square height of about 1.
const KnownProfile kKnownProfiles[] = {
    {"waves",
     [](double i) {
       return std::sin(2.0 * pi * i / 31.0) + 0.7 * std::sin(2.0 * pi * i / 83.0 + 1.0) +
              0.5 * std::sin(2.0 * pi * i / 13.7);
     }},
    {"turned",
     [](double i) {
       const double across = std::fmod(i, 47.0) / 23.5 - 1.0;
       return 3.3 * across * across + 0.4 * std::sin(0.31 * i) - 1.1;
     }},
    {"honed",
     [](double i) {
       const double z = std::sin(2.0 * pi * i / 29.0) + std::sin(2.0 * pi * i / 71.0 + 2.0) +
                        0.6 * std::sin(2.0 * pi * i / 17.0 + 0.5);
       return z > 0.3 ? 0.3 + 0.2 * (z - 0.3) : z;
     }},
};

Section sectionOf(const std::vector<double>& heights) {
  Section section;
  section.step_mm = 1.0;
  section.height = heights;
  section.covariance.assign(heights.size(), 1.0);  // each place is a sample
  section.share.assign(heights.size(), 1.0);
  section.position.resize(heights.size());
  return section;
}

// Of primary and roughness profiles of three surfaces with white noise of known size.
TEST(ProfileRatioNoise, ErrorsCoverRatiosAndDifferencesWithoutNoise) {
  const char* const typed = std::getenv("FETTLE_NOISE_SEEDS");
  const int seeds = typed == nullptr ? 40 : std::atoi(typed);
  const AskedRatios asked{.at_heights_mm = {-0.8, 0.0, 0.6},
                          .between = {{0.02, 0.98}, {0.1, 0.5}, {0.5, 0.9}}};
  const std::size_t first = roughnessInfos().size(),
                    count = asked.at_heights_mm.size() + asked.between.size();
  for (const double sigma : {0.02, 0.1}) {
    int stated = 0, within[3] = {}, possible = 0;
    for (const KnownProfile& profile : kKnownProfiles)
      for (const ProfileFilters& filters :
           {ProfileFilters{.kind = ProfileKind::kPrimary}, ProfileFilters{.cutoff_mm = 150.0}}) {
        std::vector<double> heights;
        for (std::size_t i = 0; i < kProfilePlaces; ++i)
          heights.push_back(profile.height(static_cast<double>(i)));
        const Section clean = sectionOf(heights);
        const Stretch all{0.0, clean.lengthMm()};
        const auto truth = roughnessOf(clean, all, filters, asked);
        ASSERT_TRUE(truth) << truth.error().line();
        std::vector<double> known = truth->ratios;
        known.insert(known.end(), truth->differences.begin(), truth->differences.end());
        std::vector<double> off(count), errors(count);
        for (int s = 0; s < seeds; ++s) {
          std::mt19937_64 random(2200 + static_cast<std::uint64_t>(s));
          std::normal_distribution<double> normal(0.0, sigma);
          std::vector<double> noisy = heights;
          for (double& z : noisy) z += normal(random);
          const Section section = sectionOf(noisy);
          const auto found = roughnessOf(section, all, filters, asked);
          ASSERT_TRUE(found);
          const auto noise =
              roughnessNoise(section, all, filters, *found, {sigma},
                             {.pairs = 16, .seed = 900 + 100 * static_cast<std::uint64_t>(s)}, asked);
          ASSERT_TRUE(noise);
          ASSERT_EQ(noise->size(), first + count);
          for (std::size_t i = 0; i < count; ++i) {
            const NoiseEffect& effect = (*noise)[first + i];
            ++possible;
            if (std::isnan(effect.error)) continue;
            const double away = effect.without - known[i];
            ++stated;
            for (int k = 0; k < 3; ++k) within[k] += std::abs(away) <= (k + 1) * effect.error ? 1 : 0;
            off[i] += away * away;
            errors[i] += effect.error * effect.error;
          }
        }
        std::string text;
        for (std::size_t i = 0; i < count; ++i) text += fmt::format(" {:.2f}", std::sqrt(errors[i] / off[i]));
        fmt::print("{} {}, noise {}: error over off{}\n", profile.name, profileInfo(filters.kind).word, sigma,
                   text);
      }
    fmt::print("noise {}: {} {} {} of {} stated, of {}\n", sigma, within[0], within[1], within[2], stated,
               possible);
    EXPECT_GE(stated, 0.95 * possible) << sigma;
    EXPECT_GE(within[0], 0.60 * stated) << sigma;
    EXPECT_GE(within[1], 0.88 * stated) << sigma;
    EXPECT_GE(within[2], 0.96 * stated) << sigma;
  }
}

}  // namespace
}  // namespace fettle::engine
