#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/inspect/noise_model.h"
#include "engine/measure/areal.h"
#include "engine/measure/form.h"
#include "engine/uncertainty/areal_figures.h"
#include "engine/uncertainty/noise_trial.h"
#include "tests/engine/uncertainty/known_surfaces.h"

namespace fettle::engine {
namespace {

using std::numbers::pi;
using tests::fieldOf;
using tests::kLays;
using tests::KnownSurface;
using tests::kOtherSurfaces;
using tests::kSide;
using tests::kSurfaces;

Result<ArealParameters> measuredOf(const Version& field, TrialNoise noise = TrialNoise::kOwn) {
  JobControl job;
  const auto fit = fitForm(field, {}, job);
  if (!fit) return tl::unexpected(fit.error());
  return measureAreal(field, fit->form, optionsOf({}, noise), job);
}

const std::vector<NoiseGrowth>& growths() {
  static const std::vector<NoiseGrowth> all = growthsOf(ArealParameters{});
  return all;
}

struct Coverage {
  int stated = 0, within[3] = {};
  double truth = 0.0, raise = 0.0, left = 0.0, error = 0.0;  // sums
  double off = 0.0, errors = 0.0;                            // of squares
};

std::vector<Coverage> coverageOf(const std::vector<double>& truth, double sigma, int seeds, int pairs,
                                 std::uint64_t first_seed, double rows_off = 0.0) {
  const std::vector<double> known = valuesOf(*measuredOf(fieldOf(truth)));
  std::vector<Coverage> all(known.size());
  for (int s = 0; s < seeds; ++s) {
    std::mt19937_64 random(first_seed + static_cast<std::uint64_t>(s));
    std::normal_distribution<double> normal(0.0, sigma);
    std::vector<double> noisy = truth;
    for (double& z : noisy) z += normal(random);
    if (rows_off > 0.0)
      for (std::size_t r = 0; r < kSide; ++r) {
        const double off = rows_off / sigma * normal(random);
        for (std::size_t c = 0; c < kSide; ++c) noisy[r * kSide + c] += off;
      }
    const Version field = fieldOf(noisy);
    JobControl job;
    const auto model = measureNoise(field, job);
    EXPECT_TRUE(model);
    const ArealParameters measured = *measuredOf(field);
    const std::vector<double> found = valuesOf(measured);
    const auto effects =
        arealEffects(field, *model, measured, measuredOf,
                     {.pairs = pairs, .seed = 77 + 1000 * static_cast<std::uint64_t>(s)}, job);
    EXPECT_TRUE(effects);
    for (std::size_t i = 0; i < known.size(); ++i) {
      const NoiseEffect& e = (*effects)[i];
      if (std::isnan(e.error) || std::isnan(known[i])) continue;
      double off = e.without - known[i];
      if (growths()[i] == NoiseGrowth::kAxis) off -= 180.0 * std::round(off / 180.0);
      Coverage& c = all[i];
      ++c.stated;
      for (int k = 0; k < 3; ++k) c.within[k] += std::abs(off) <= (k + 1) * e.error ? 1 : 0;
      c.off += off * off;
      c.errors += e.error * e.error;
      c.truth += known[i];
      c.raise += found[i] - known[i];
      c.left += off;
      c.error += e.error;
    }
  }
  return all;
}

int seedsOf(int few) {
  const char* const typed = std::getenv("FETTLE_NOISE_SEEDS");
  return typed == nullptr ? few : std::atoi(typed);
}

// What no error covers (docs/decisions/parameter-errors.md): Std of waves along y has an error of 1e-3 degrees, below its search; peaks and Smrk1 of a
// surface with steps as high as ten times the noise.
bool excepted(const std::string& surface, double sigma, std::string_view key) {
  if (surface == "waves") return key == "std";
  return surface == "steps" && sigma > 0.05 && (key == "smrk1" || key == "spc" || key == "spk");
}

// Shares of all figures of these surfaces and noises that are within one, two and three errors. Each figure is printed.
Coverage togetherOf(std::span<const KnownSurface> surfaces, int seeds, int pairs, std::uint64_t first_seed) {
  Coverage whole;
  for (const KnownSurface& surface : surfaces) {
    const std::vector<double> truth = surface.heights();
    for (const double sigma : {0.02, 0.1, 0.3}) {
      if (sigma > 0.2 && seeds < 10) continue;
      const auto all = coverageOf(truth, sigma, seeds, pairs, first_seed);
      fmt::print("{}, noise {}, {} pairs\n", surface.name, sigma, pairs);
      Coverage of_noise;
      for (std::size_t i = 0; i < all.size(); ++i) {
        const Coverage& c = all[i];
        if (c.stated == 0) continue;
        const std::string_view key = arealFigures()[i].key;
        const double n = c.stated;
        fmt::print(
            "  {:6} n {:3} truth {:9.4g} raised {:9.3g} left {:9.3g} error {:9.3g}  {:5.2f} {:5.2f} "
            "{:5.2f}\n",
            key, c.stated, c.truth / n, c.raise / n, c.left / n, c.error / n, c.within[0] / n,
            c.within[1] / n, c.within[2] / n);
        of_noise.stated += c.stated;
        for (int k = 0; k < 3; ++k) of_noise.within[k] += c.within[k];
        if (sigma > 0.2 || excepted(surface.name, sigma, key)) continue;
        whole.stated += c.stated;
        for (int k = 0; k < 3; ++k) whole.within[k] += c.within[k];
        if (seeds < 100) continue;
        // Below the shares of Student by what a surface's own extrapolation leaves.
        EXPECT_GE(c.within[0], 0.40 * n) << surface.name << " " << sigma << " " << key;
        EXPECT_GE(c.within[1], 0.75 * n) << surface.name << " " << sigma << " " << key;
        EXPECT_GE(c.within[2], 0.85 * n) << surface.name << " " << sigma << " " << key;
      }
      fmt::print("  {} of this noise: {:.3f} {:.3f} {:.3f}\n", of_noise.stated,
                 of_noise.within[0] / double(of_noise.stated), of_noise.within[1] / double(of_noise.stated),
                 of_noise.within[2] / double(of_noise.stated));
    }
  }
  fmt::print("together {}: {:.3f} {:.3f} {:.3f}\n", whole.stated, whole.within[0] / double(whole.stated),
             whole.within[1] / double(whole.stated), whole.within[2] / double(whole.stated));
  return whole;
}

// Each surface with noise of a fiftieth and a tenth of its height, which is measured as well as it may be (measureNoise). All
// figures and surfaces together are as many draws as seeds times 180; each alone is only checked by hundreds of seeds. With
// 0.3 it is printed: what is of ranks or peaks is then another surface's.
TEST(ArealNoise, ErrorsCoverTheTruthOfKnownSurfaces) {
  const int seeds = seedsOf(3);
  const Coverage whole = togetherOf(kSurfaces, seeds, 8, 1000);
  EXPECT_GT(whole.stated, 150 * seeds);
  // Figures of one scan go together, so that the draws are no more than some ten per scan: of 240, 4 standard deviations.
  EXPECT_GE(whole.within[0], 0.55 * whole.stated);
  EXPECT_GE(whole.within[1], 0.86 * whole.stated);
  EXPECT_GE(whole.within[2], 0.94 * whole.stated);
}

// Means of five extremes and Sa where noise is a fifth of the surface: what is stated is covered, and peaks of hills that noise makes are not stated.
TEST(ArealNoise, MeansOfFiveExtremesUnderLoudNoise) {
  const int seeds = seedsOf(4);
  for (const double sigma : {0.1, 0.2}) {
    Coverage fives, mean;
    const auto add = [&](const KnownSurface& surface) {
      const auto all = coverageOf(surface.heights(), sigma, seeds, 8, 9500);
      for (const std::string_view key : {"sa", "s5p", "s5v", "s10z"}) {
        const Coverage& c = all[static_cast<std::size_t>(&arealFigure(key) - arealFigures().data())];
        fmt::print("{}, noise {}: {:4} n {:3} raised {:6.3f} left {:6.3f} of it, error over off {:5.2f}\n",
                   surface.name, sigma, key, c.stated, c.raise / c.truth, c.left / c.truth,
                   std::sqrt(c.errors / c.off));
        Coverage& sum = key == "sa" ? mean : fives;
        sum.stated += c.stated;
        for (int k = 0; k < 3; ++k) sum.within[k] += c.within[k];
      }
    };
    for (const KnownSurface& surface : kSurfaces) add(surface);
    for (const KnownSurface& surface : kOtherSurfaces) add(surface);
    for (const Coverage& c : {fives, mean})
      fmt::print("noise {}: {} {} {} of {}\n", sigma, c.within[0], c.within[1], c.within[2], c.stated);
    EXPECT_EQ(mean.stated, 8 * seeds);
    EXPECT_GE(mean.within[0], 0.5 * mean.stated);
    EXPECT_GE(mean.within[1], 0.85 * mean.stated);
    EXPECT_GE(fives.within[1], 0.85 * fives.stated);
    if (sigma > 0.15)
      EXPECT_LT(fives.stated, 6 * seeds);
    else
      EXPECT_EQ(fives.stated, 24 * seeds);
  }
}

// Waves that just reach a correlation of 0.2 in one direction have a Str of 0.15, or of 0.45 where noise lowers it to there; trials with more noise
// do not lead back, so that it was stated as 0.45 with an error of a hundredth.
TEST(ArealNoise, StrIsNotStatedWhereNoiseDecidesWhichDirectionDecaysLast) {
  const auto str = static_cast<std::size_t>(&arealFigure("str") - arealFigures().data());
  // Of 20 scans one was stated, 62 errors off, while what noise scatters the autocorrelation was not taken over its level.
  EXPECT_EQ(coverageOf(kSurfaces[3].heights(), 0.1, 20, 2, 1000)[str].stated, 0);
  const int seeds = 2;
  const Coverage lay = coverageOf(kSurfaces[1].heights(), 0.1, seeds, 2, 1000)[str];
  EXPECT_EQ(lay.stated, seeds);
  EXPECT_EQ(lay.within[2], seeds);
}

// Str alone, which is quick, of all surfaces: by as few trials as a million samples have. Two roughnesses, whose autocorrelation falls slowly around
// 0.2, had errors of 0.45 of what Str was off with noise of 0.3, where trials led away from it.
TEST(ArealNoise, StrOfAllSurfacesIsCovered) {
  const auto str = static_cast<std::size_t>(&arealFigure("str") - arealFigures().data());
  const auto spatialOf = [](const Version& field, TrialNoise) {
    JobControl job;
    const auto fit = fitForm(field, {}, job);
    return measureAreal(field, fit->form, {.hybrid = false, .functional = false, .feature = false}, job);
  };
  const int seeds = seedsOf(6);
  for (const double sigma : {0.02, 0.1, 0.3}) {
    Coverage together;
    for (const std::span<const KnownSurface> all :
         {std::span<const KnownSurface>(kSurfaces), std::span<const KnownSurface>(kOtherSurfaces)})
      for (const KnownSurface& surface : all) {
        const std::vector<double> truth = surface.heights();
        const double known = spatialOf(fieldOf(truth), TrialNoise::kOwn)->spatial.str;
        Coverage of;
        for (int s = 0; s < seeds; ++s) {
          std::mt19937_64 random(120000 + static_cast<std::uint64_t>(s));
          std::normal_distribution<double> normal(0.0, sigma);
          std::vector<double> noisy = truth;
          for (double& z : noisy) z += normal(random);
          const Version field = fieldOf(noisy);
          JobControl job;
          const auto model = measureNoise(field, job);
          const ArealParameters measured = *spatialOf(field, TrialNoise::kOwn);
          const auto effects =
              arealEffects(field, *model, measured, spatialOf,
                           {.pairs = 2, .seed = 77 + 1000 * static_cast<std::uint64_t>(s)}, job);
          const NoiseEffect& e = (*effects)[str];
          if (std::isnan(e.error) || std::isnan(known)) continue;
          const double off = e.without - known;
          ++of.stated;
          for (int k = 0; k < 3; ++k) of.within[k] += std::abs(off) <= (k + 1) * e.error ? 1 : 0;
          of.off += off * off;
          of.errors += e.error * e.error;
        }
        if (of.stated == 0) continue;
        const double ratio = std::sqrt(of.errors / of.off);
        fmt::print("{}, noise {}: {} stated, within {} {} {}, error over off {:.2f}\n", surface.name, sigma,
                   of.stated, of.within[0], of.within[1], of.within[2], ratio);
        EXPECT_GT(ratio, 0.6) << surface.name << ' ' << sigma;
        together.stated += of.stated;
        for (int k = 0; k < 3; ++k) together.within[k] += of.within[k];
      }
    fmt::print("noise {}: {} {} {} of {}\n", sigma, together.within[0], together.within[1],
               together.within[2], together.stated);
    EXPECT_GE(together.within[0], 0.55 * together.stated);
    EXPECT_GE(together.within[1], 0.86 * together.stated);
    EXPECT_GE(together.within[2], 0.94 * together.stated);
  }
}

// Rows that are off have their power in one direction, which is no lay, and waves along it: Std and Ssw are not stated where they may decide them,
// and stated where they do not.
TEST(ArealNoise, SpatialParametersWhereRowsAreOff) {
  const int seeds = seedsOf(4);
  const auto indexOf = [](std::string_view key) {
    return static_cast<std::size_t>(&arealFigure(key) - arealFigures().data());
  };
  Coverage together;
  for (const KnownSurface* surface : {&kSurfaces[0], &kSurfaces[1], &kSurfaces[3], &kLays[0], &kLays[1]})
    for (const double rows_off : {0.05, 0.3, 1.0}) {
      const auto all = coverageOf(surface->heights(), 0.03, seeds, 8, 9000, rows_off);
      for (const std::string_view key : {"sal", "std", "ssw"}) {
        const Coverage& c = all[indexOf(key)];
        const double n = c.stated;
        fmt::print(
            "{}, rows off {}: {:6} n {:3} truth {:9.4g} raised {:9.3g} left {:9.3g} error over off {:5.2f}  "
            "{:5.2f} {:5.2f} {:5.2f}\n",
            surface->name, rows_off, key, c.stated, c.truth / n, c.raise / n, c.left / n,
            std::sqrt(c.errors / c.off), c.within[0] / n, c.within[1] / n, c.within[2] / n);
        together.stated += c.stated;
        for (int k = 0; k < 3; ++k) together.within[k] += c.within[k];
      }
      if (rows_off > 0.9) {
        EXPECT_EQ(all[indexOf("std")].stated, 0) << surface->name;
      }
      // A lay along rows is drawn to 0 by rows that are off: stated, its error was 0.42 of what it was off.
      if (rows_off < 0.1 && surface != &kSurfaces[0]) {
        EXPECT_EQ(all[indexOf("std")].stated, surface == &kLays[0] ? 0 : seeds) << surface->name;
      }
    }
  fmt::print("together {}: {} {} {}\n", together.stated, together.within[0], together.within[1],
             together.within[2]);
  EXPECT_GE(together.within[0], 0.5 * together.stated);
  EXPECT_GE(together.within[1], 0.85 * together.stated);
  EXPECT_GE(together.within[2], 0.93 * together.stated);
}

// By as few trials as a million samples have by themselves, on surfaces and seeds that no share was chosen on.
TEST(ArealNoise, ErrorsOfFourTrialsCoverTheTruthOfOtherSurfaces) {
  const int seeds = seedsOf(3);
  const Coverage whole = togetherOf(kOtherSurfaces, seeds, 2, 50000);
  EXPECT_GT(whole.stated, 150 * seeds);
  EXPECT_GE(whole.within[0], 0.55 * whole.stated);
  // Of two pairs, two and three errors reach less far into Student's tails: 0.88 and 0.94 of normal figures.
  EXPECT_GE(whole.within[1], 0.82 * whole.stated);
  EXPECT_GE(whole.within[2], 0.90 * whole.stated);
}

// The same by as many as a small scan has.
TEST(ArealNoise, ErrorsOfSixteenTrialsCoverTheTruthOfOtherSurfaces) {
  if (std::getenv("FETTLE_NOISE_SEEDS") == nullptr) GTEST_SKIP() << "set FETTLE_NOISE_SEEDS";
  const int seeds = seedsOf(3);
  const Coverage whole = togetherOf(kOtherSurfaces, seeds, 8, 90000);
  EXPECT_GE(whole.within[0], 0.55 * whole.stated);
  EXPECT_GE(whole.within[1], 0.86 * whole.stated);
  EXPECT_GE(whole.within[2], 0.94 * whole.stated);
}

// Root mean square of what Sq and Sa without noise are off, and the mean error that is stated.
struct Scatter {
  double squares = 0.0, errors = 0.0;
  int within = 0, all = 0;

  void add(const NoiseEffect& effect, double known) {
    const double off = effect.without - known;
    squares += off * off;
    errors += effect.error;
    within += std::abs(off) <= effect.error ? 1 : 0;
    ++all;
  }
  [[nodiscard]] double errorOverScatter() const { return errors / std::sqrt(squares * all); }
};

// Heights alone: the other groups take most of the time.
Result<ArealParameters> heightParametersOf(const Version& field, TrialNoise = TrialNoise::kOwn) {
  JobControl job;
  const auto fit = fitForm(field, {}, job);
  if (!fit) return tl::unexpected(fit.error());
  return measureAreal(field, fit->form,
                      {.hybrid = false, .functional = false, .spatial = false, .feature = false}, job);
}

// Of noise `sigma`, `lines` of whose square each row has in common, by the noise that is there and by that which is
// measured in the scan: the error of Sq, of Sa over their scatter in one surface. Printed.
std::array<double, 2> errorsOverScatter(const KnownSurface& surface, double sigma, double lines, int seeds) {
  constexpr std::size_t kFigures[] = {0, 6};  // Sq, Sa
  const std::vector<double> truth = surface.heights();
  const std::vector<double> known = valuesOf(*heightParametersOf(fieldOf(truth)));
  Scatter scatters[2][2];
  for (int seed = 0; seed < seeds; ++seed) {
    std::mt19937_64 random(7000 + static_cast<std::uint64_t>(seed));
    std::normal_distribution<double> normal(0.0, sigma);
    std::vector<double> noisy = truth;
    double of_row = 0.0;
    for (std::size_t i = 0; i < noisy.size(); ++i) {
      if (i % kSide == 0) of_row = std::sqrt(lines) * normal(random);
      noisy[i] += of_row + std::sqrt(1.0 - lines) * normal(random);
    }
    const Version field = fieldOf(noisy);
    JobControl job;
    NoiseModel models[2];
    models[0].sigma = sigma;
    models[0].parts.uncorrelated = (1.0 - lines) * sigma * sigma;
    models[0].parts.row_offset = lines * sigma * sigma;
    models[1] = *measureNoise(field, job);
    const ArealParameters found = *heightParametersOf(field);
    for (std::size_t m = 0; m < 2; ++m) {
      const auto effects =
          arealEffects(field, models[m], found, heightParametersOf,
                       {.pairs = 8, .seed = 5 + 100 * static_cast<std::uint64_t>(seed)}, job);
      EXPECT_TRUE(effects);
      for (std::size_t f = 0; f < 2; ++f) scatters[m][f].add((*effects)[kFigures[f]], known[kFigures[f]]);
    }
  }
  fmt::print("{}, noise {}, of lines {}: errors over scatter", surface.name, sigma, lines);
  std::array<double, 2> both{};
  for (std::size_t m = 0; m < 2; ++m) {
    const Scatter &sq = scatters[m][0], &sa = scatters[m][1];
    both[m] = 0.5 * (sq.errorOverScatter() + sa.errorOverScatter());
    fmt::print(" {} Sq {:.2f} ({:.2f} within), Sa {:.2f} ({:.2f});",
               m == 0 ? "by the true noise" : "by the measured", sq.errorOverScatter(),
               sq.within / static_cast<double>(seeds), sa.errorOverScatter(),
               sa.within / static_cast<double>(seeds));
  }
  fmt::print("\n");
  return both;
}

// Errors of Sq and Sa of quiet scans are as large as the scatter of what is stated, whether samples of a row share some of the
// noise or none. Roughness that counted as what lines share made them 3.2 times as large where they share nothing.
TEST(ArealNoise, ErrorsOfQuietScansAreTheirScatter) {
  const bool soak = std::getenv("FETTLE_NOISE_SEEDS") != nullptr;
  const int seeds = seedsOf(6);
  for (const double lines : {0.0, 0.2})
    for (const double sigma : {0.005, 0.02}) {
      if (!soak && sigma < 0.01) continue;
      double by_true = 0.0, by_measured = 0.0;
      for (const KnownSurface& surface : kSurfaces) {
        const auto [with_true, with_measured] = errorsOverScatter(surface, sigma, lines, seeds);
        by_true += with_true / static_cast<double>(std::size(kSurfaces));
        by_measured += with_measured / static_cast<double>(std::size(kSurfaces));
      }
      // The scatter of six seeds and four surfaces is known to some 15 %.
      EXPECT_NEAR(by_true, 1.1, 0.5) << lines << ' ' << sigma;
      EXPECT_GT(by_measured, 0.6) << lines << ' ' << sigma;
      EXPECT_LT(by_measured, 1.9) << lines << ' ' << sigma;
      if (!soak) continue;
      for (const std::span<const KnownSurface> others :
           {std::span<const KnownSurface>(kOtherSurfaces), std::span<const KnownSurface>(kLays)})
        for (const KnownSurface& surface : others) errorsOverScatter(surface, sigma, lines, seeds);
    }
}

// Surfaces on which no share or factor was chosen, of any number of samples.
struct SizedSurface {
  const char* name;
  double (*height)(double c, double r);
};
const SizedSurface kSizedSurfaces[] = {
    {"long wave", [](double c, double r) { return 1.41 * std::sin(2.0 * pi * (c / 83.0 + r / 410.0)); }},
    {"plane with roughness",
     [](double c, double r) {
       // Forty waves of 9 to 60 samples in directions and phases of no order.
       double sum = 0.002 * c - 0.001 * r;
       for (int k = 0; k < 40; ++k) {
         const double turn = 2.399963 * k, length = 9.0 + 51.0 * std::fmod(0.618034 * k, 1.0);
         sum += 0.22 * std::sin(2.0 * pi * (c * std::cos(turn) + r * std::sin(turn)) / length + 1.7 * k * k);
       }
       return sum;
     }},
    {"bumps",
     [](double c, double r) {
       const double x = std::fmod(c + 11.0 * std::floor(r / 37.0), 41.0) - 20.0,
                    y = std::fmod(r, 37.0) - 18.0;
       return 3.5 * std::exp(-(x * x + y * y) / 120.0) + 0.3 * std::sin(0.021 * c * 0.07 * r);
     }},
    {"turned, with tool marks",
     [](double c, double r) {
       const double across = std::fmod(c + 0.05 * r, 62.0) / 31.0 - 1.0;
       return 3.3 * across * across + 0.3 * std::sin(0.13 * r + 0.02 * c);
     }},
};

struct Spread {
  double squares = 0.0, errors = 0.0;
  int within[3] = {}, all = 0;
  [[nodiscard]] double ratio() const { return squares > 0.0 ? errors / std::sqrt(squares * all) : 1.0; }
};

// Errors of height, hybrid and functional parameters of scans with white noise over the root mean square of what the figures without noise are off.
// FETTLE_NOISE_SEEDS has 500 x 500 samples, with 160 x 160 otherwise. Sp, Sv and Sz are left out, which
// the table of the decision has; so is what the truth has at an end of its range.
TEST(ArealNoise, ErrorsOfWhiteNoiseAreTheSpreadOfWhatTheyAreOf) {
  const bool soak = std::getenv("FETTLE_NOISE_SEEDS") != nullptr;
  const int seeds = seedsOf(8), side = soak ? 500 : 160;
  const auto smooth = [](std::string_view key) {
    return key == "sdq" || key == "sdr" || key == "sq" || key == "sa" || key == "ssk" || key == "sku";
  };
  for (const double share : {0.01, 0.03, 0.1}) {
    if (!soak && share < 0.02) continue;
    Spread smooths, ranks;
    std::vector<double> ratios;
    for (const SizedSurface& surface : kSizedSurfaces) {
      std::vector<double> truth;
      for (int r = 0; r < side; ++r)
        for (int c = 0; c < side; ++c) truth.push_back(surface.height(c, r));
      Grid grid;
      grid.width = grid.height = side;
      const auto field = [&](const std::vector<double>& z) {
        const std::vector<float> heights(z.begin(), z.end());
        return makeField(grid, heights, {});
      };
      const auto measure = [](const Version& of, TrialNoise) -> Result<ArealParameters> {
        JobControl job;
        const auto fit = fitForm(of, {}, job);
        if (!fit) return tl::unexpected(fit.error());
        return measureAreal(of, fit->form, {.spatial = false, .feature = false}, job);
      };
      const ArealParameters clean = *measure(field(truth), TrialNoise::kOwn);
      const std::vector<double> known = valuesOf(clean);
      std::vector<Spread> spreads(known.size());
      for (int s = 0; s < seeds; ++s) {
        std::mt19937_64 random(310000 + static_cast<std::uint64_t>(s));
        std::normal_distribution<double> normal(0.0, share * clean.sq);
        std::vector<double> noisy = truth;
        for (double& z : noisy) z += normal(random);
        const Version scan = field(noisy);
        JobControl job;
        const auto model = measureNoise(scan, job);
        ASSERT_TRUE(model);
        const ArealParameters found = *measure(scan, TrialNoise::kOwn);
        const auto effects = arealEffects(scan, *model, found, measure,
                                          {.pairs = 8, .seed = 9 + 100 * static_cast<std::uint64_t>(s)}, job);
        ASSERT_TRUE(effects);
        for (std::size_t i = 0; i < known.size(); ++i) {
          const double off = (*effects)[i].without - known[i], error = (*effects)[i].error;
          if (std::isnan(off) || std::isnan(error)) continue;
          Spread& of = spreads[i];
          of.squares += off * off;
          of.errors += error;
          ++of.all;
          for (int k = 0; k < 3; ++k) of.within[k] += std::abs(off) <= (k + 1) * error ? 1 : 0;
        }
      }
      for (std::size_t i = 0; i < arealFigures().size(); ++i) {
        const std::string_view key = arealFigures()[i].key;
        const Spread& of = spreads[i];
        if (arealFigures()[i].growth == NoiseGrowth::kExtreme || key == "sal" || of.squares == 0.0) continue;
        if (2 * of.all < seeds) continue;
        fmt::print(
            "{:24} noise {:.2f} {:6} {} stated, error over spread {:5.2f}, within {:.2f} {:.2f} {:.2f}\n",
            surface.name, share, key, of.all, of.ratio(), of.within[0] / double(of.all),
            of.within[1] / double(of.all), of.within[2] / double(of.all));
        Spread& sum = smooth(key) ? smooths : ranks;
        sum.all += of.all;
        for (int k = 0; k < 3; ++k) sum.within[k] += of.within[k];
        ratios.push_back(of.ratio());
        // The spread of eight is known to a quarter, and the model sees the noise that raised the slopes; before they were 8 to 73 times it.
        if (key == "sdq" || key == "sdr") {
          EXPECT_LT(of.ratio(), 3.6) << surface.name << ' ' << key << ' ' << share;
        }
      }
    }
    for (const auto& [name, sum] : {std::pair{"moments and slopes", smooths}, {"ranks", ranks}}) {
      fmt::print("noise {:.2f}, {} of {}: within {:.3f} {:.3f} {:.3f}\n", share, sum.all, name,
                 sum.within[0] / double(sum.all), sum.within[1] / double(sum.all),
                 sum.within[2] / double(sum.all));
      EXPECT_GE(sum.within[0], 0.52 * sum.all) << name << ' ' << share;
      EXPECT_GE(sum.within[1], 0.84 * sum.all) << name << ' ' << share;
      EXPECT_GE(sum.within[2], 0.93 * sum.all) << name << ' ' << share;
    }
    std::ranges::sort(ratios);
    fmt::print(
        "noise {:.2f}, error over spread of {} figures: least {:.2f}, median {:.2f}, nine in ten {:.2f}, "
        "most {:.2f}\n",
        share, ratios.size(), ratios.front(), ratios[ratios.size() / 2], ratios[ratios.size() * 9 / 10],
        ratios.back());
    // Five of six were above 1.5 of noise of a tenth before.
    EXPECT_LT(ratios[ratios.size() / 2], 1.5) << share;
    EXPECT_LT(ratios[ratios.size() * 9 / 10], 3.0) << share;
  }
}

}  // namespace
}  // namespace fettle::engine
