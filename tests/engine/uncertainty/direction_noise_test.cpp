// Std without noise: of surfaces alike in all directions noise decides which is the strongest, of those with a lay it is known.
#include "engine/uncertainty/direction_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <tuple>
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
using tests::randomTexture;

Result<ArealParameters> directionOf(const Version& field, TrialNoise noise = TrialNoise::kOwn) {
  JobControl job;
  const auto fit = fitForm(field, {}, job);
  if (!fit) return tl::unexpected(fit.error());
  return measureAreal(field, fit->form,
                      optionsOf({.hybrid = false, .functional = false, .feature = false}, noise), job);
}

struct DirectedSurface {
  std::string name;
  std::vector<double> heights;
};

struct DirectionCoverage {
  int scans = 0, stated = 0, within[3] = {};
  double off = 0.0, errors = 0.0, sum = 0.0;  // of squares; of what it is off [degrees]

  void add(const NoiseEffect& effect, double truth) {
    ++scans;
    if (std::isnan(effect.error)) return;
    ++stated;
    const double away = effect.without - truth, turn = away - 180.0 * std::round(away / 180.0);
    for (int k = 0; k < 3; ++k) within[k] += std::abs(turn) <= (k + 1) * effect.error ? 1 : 0;
    off += turn * turn;
    errors += effect.error * effect.error;
    sum += turn;
  }
  void add(const DirectionCoverage& of) {
    scans += of.scans;
    stated += of.stated;
    for (int k = 0; k < 3; ++k) within[k] += of.within[k];
    off += of.off;
    errors += of.errors;
    sum += of.sum;
  }
  [[nodiscard]] std::string text() const {
    const double n = std::max(1, stated);
    return fmt::format(
        "{} of {} stated, off {:.2f} (mean {:.2f}) with errors of {:.2f}, within {:.2f} {:.2f} {:.2f}",
        stated, scans, std::sqrt(off / n), sum / n, std::sqrt(errors / n), within[0] / n, within[1] / n,
        within[2] / n);
  }
};

DirectionCoverage directionCoverage(const DirectedSurface& surface, double sigma, int seeds, int pairs,
                                    std::uint64_t first_seed) {
  const double truth = directionOf(fieldOf(surface.heights))->spatial.lay;
  DirectionCoverage coverage;
  for (int s = 0; s < seeds; ++s) {
    std::mt19937_64 random(first_seed + static_cast<std::uint64_t>(s));
    std::normal_distribution<double> normal(0.0, sigma);
    std::vector<double> noisy = surface.heights;
    for (double& z : noisy) z += normal(random);
    const Version field = fieldOf(noisy);
    JobControl job;
    const auto model = measureNoise(field, job);
    EXPECT_TRUE(model);
    const auto effects =
        arealEffects(field, *model, *directionOf(field), directionOf,
                     {.pairs = pairs, .seed = 11 + 100 * static_cast<std::uint64_t>(s)}, job);
    EXPECT_TRUE(effects);
    coverage.add((*effects)[static_cast<std::size_t>(&arealFigure("std") - arealFigures().data())], truth);
  }
  fmt::print("{}, noise {}: Std {:.2f}, {}\n", surface.name, sigma, truth, coverage.text());
  return coverage;
}

// Textures that nothing was chosen on.
std::vector<DirectedSurface> alikeInAllDirections(unsigned seed, unsigned count) {
  std::vector<DirectedSurface> surfaces;
  for (unsigned k = 0; k < count; ++k) {
    const double a = 2.5 + 0.75 * k;
    surfaces.push_back({fmt::format("isotropic, {} samples", a), randomTexture(a, a, 0.0, seed + k)});
  }
  return surfaces;
}
std::vector<DirectedSurface> withALay(unsigned seed) {
  std::vector<DirectedSurface> surfaces;
  for (const auto& [a, b, degrees] :
       {std::tuple(5.0, 4.0, 20.0), {6.0, 4.0, 75.0}, {5.0, 3.0, 130.0}, {8.0, 3.0, 160.0}})
    surfaces.push_back(
        {fmt::format("lay of {} to {} samples at {}", a, b, degrees), randomTexture(a, b, degrees, seed++)});
  return surfaces;
}

TEST(DirectionNoise, ErrorsCoverTheDirectionOfSurfacesWithAndWithoutALay) {
  const char* const typed = std::getenv("FETTLE_NOISE_SEEDS");
  const int seeds = typed == nullptr ? 3 : std::atoi(typed);
  for (const double sigma : {0.1, 0.3}) {
    DirectionCoverage alike, lays;
    for (const DirectedSurface& surface : alikeInAllDirections(701, 5))
      alike.add(directionCoverage(surface, sigma, seeds, 8, 880000));
    for (const DirectedSurface& surface : withALay(731))
      lays.add(directionCoverage(surface, sigma, seeds, 8, 890000));
    fmt::print("noise {}, alike in all directions: {}\n", sigma, alike.text());
    fmt::print("noise {}, with a lay: {}\n", sigma, lays.text());
    DirectionCoverage both = alike;
    both.add(lays);
    EXPECT_GE(lays.stated, lays.scans / 2);
    EXPECT_GE(both.within[0], 0.5 * both.stated);
    EXPECT_GE(both.within[1], 0.8 * both.stated);
    EXPECT_GE(both.within[2], 0.92 * both.stated);
  }
}

}  // namespace
}  // namespace fettle::engine
