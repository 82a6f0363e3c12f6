// Errors by noise of what is asked of the material ratio curve: Vm(p), Vv(p) and Sdc.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/inspect/noise_model.h"
#include "engine/measure/areal.h"
#include "engine/measure/form.h"
#include "engine/uncertainty/areal_figures.h"
#include "engine/uncertainty/noise_trial.h"
#include "tests/engine/uncertainty/known_surfaces.h"

namespace fettle::engine {
namespace {

using tests::fieldOf;
using tests::kLays;
using tests::KnownSurface;
using tests::kOtherSurfaces;
using tests::kSurfaces;

const std::vector<double> kVolumes{0.05, 0.3, 0.6, 0.95};
const std::vector<RatioPair> kPairs{{0.025, 0.975}, {0.2, 0.7}};

Result<ArealParameters> measuredAsAsked(const Version& field, TrialNoise noise = TrialNoise::kOwn) {
  JobControl job;
  const auto fit = fitForm(field, {}, job);
  if (!fit) return tl::unexpected(fit.error());
  const ArealOptions options{
      .hybrid = false, .spatial = false, .feature = false, .at_volumes = kVolumes, .between = kPairs};
  return measureAreal(field, fit->form, optionsOf(options, noise), job);
}

struct AskedCoverage {
  int stated = 0, within[3] = {};
  double off = 0.0, errors = 0.0;  // of squares

  void add(double away, double error) {
    ++stated;
    for (int k = 0; k < 3; ++k) within[k] += std::abs(away) <= (k + 1) * error ? 1 : 0;
    off += away * away;
    errors += error * error;
  }
  [[nodiscard]] std::string text() const {
    return fmt::format("{:4} stated, within {:.2f} {:.2f} {:.2f}, error over off {:.2f}", stated,
                       within[0] / double(stated), within[1] / double(stated), within[2] / double(stated),
                       std::sqrt(errors / off));
  }
};

// On ten surfaces under white noise of a fiftieth and a tenth of their height; no figure of these has a rule of its own.
TEST(AskedRatios, ErrorsCoverVolumesAndDifferencesWithoutNoise) {
  const char* const typed = std::getenv("FETTLE_NOISE_SEEDS");
  const int seeds = typed == nullptr ? 4 : std::atoi(typed);
  std::vector<const KnownSurface*> surfaces;
  for (const KnownSurface& surface : kSurfaces) surfaces.push_back(&surface);
  for (const KnownSurface& surface : kOtherSurfaces) surfaces.push_back(&surface);
  for (const KnownSurface& surface : kLays) surfaces.push_back(&surface);
  const std::size_t first = arealFigures().size(), asked = 2 * kVolumes.size() + kPairs.size();
  for (const double sigma : {0.02, 0.1}) {
    std::vector<AskedCoverage> figures(asked);
    AskedCoverage volumes, differences;
    for (const KnownSurface* surface : surfaces) {
      const std::vector<double> truth = surface->heights();
      const std::vector<double> known = valuesOf(*measuredAsAsked(fieldOf(truth)));
      ASSERT_EQ(known.size(), first + asked);
      AskedCoverage of_surface;
      for (int s = 0; s < seeds; ++s) {
        std::mt19937_64 random(640000 + static_cast<std::uint64_t>(s));
        std::normal_distribution<double> normal(0.0, sigma);
        std::vector<double> noisy = truth;
        for (double& z : noisy) z += normal(random);
        const Version field = fieldOf(noisy);
        JobControl job;
        const auto model = measureNoise(field, job);
        ASSERT_TRUE(model);
        const auto effects = arealEffects(field, *model, *measuredAsAsked(field), measuredAsAsked,
                                          {.pairs = 8, .seed = 3 + 100 * static_cast<std::uint64_t>(s)}, job);
        ASSERT_TRUE(effects);
        for (std::size_t i = 0; i < asked; ++i) {
          const NoiseEffect& effect = (*effects)[first + i];
          if (std::isnan(effect.error)) continue;
          const double away = effect.without - known[first + i];
          figures[i].add(away, effect.error);
          of_surface.add(away, effect.error);
          (i < 2 * kVolumes.size() ? volumes : differences).add(away, effect.error);
        }
      }
      fmt::print("{}, noise {}: {}\n", surface->name, sigma, of_surface.text());
    }
    for (std::size_t i = 0; i < asked; ++i)
      fmt::print("noise {} figure {}: {}\n", sigma, i, figures[i].text());
    for (const auto& [name, sum] : {std::pair("volumes", volumes), {"differences", differences}}) {
      fmt::print("noise {} {}: {}\n", sigma, name, sum.text());
      EXPECT_GE(sum.stated, 0.95 * seeds * static_cast<double>(surfaces.size()) *
                                static_cast<double>(name[0] == 'v' ? 2 * kVolumes.size() : kPairs.size()));
      // Figures of one scan go together: some forty draws of four seeds, three standard deviations.
      EXPECT_GE(sum.within[0], 0.50 * sum.stated) << name;
      EXPECT_GE(sum.within[1], 0.85 * sum.stated) << name;
      EXPECT_GE(sum.within[2], 0.94 * sum.stated) << name;
    }
  }
}

}  // namespace
}  // namespace fettle::engine
