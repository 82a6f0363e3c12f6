#include "engine/uncertainty/areal_figures.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>

namespace fettle::engine {

namespace {

using P = ArealParameters;
using G = NoiseGrowth;

constexpr FigureRange kFromZero{.low = 0.0}, kShareRange{0.0, 1.0};

constexpr ArealFigure kFigures[] = {
    {"sq", [](const P& p) { return p.sq; }, G::kSquare, kFromZero},
    {"ssk", [](const P& p) { return p.ssk; }, G::kCurved, {}},
    {"sku", [](const P& p) { return p.sku; }, G::kCurved, {.low = 1.0}},
    {"sp", [](const P& p) { return p.sp; }, G::kExtreme, kFromZero},
    {"sv", [](const P& p) { return p.sv; }, G::kExtreme, kFromZero},
    {"sz", [](const P& p) { return p.sz; }, G::kExtreme, kFromZero},
    {"sa", [](const P& p) { return p.sa; }, G::kSquare, kFromZero},
    {"sal", [](const P& p) { return p.spatial.sal; }, G::kPlain, kFromZero},
    {"str", [](const P& p) { return p.spatial.str; }, G::kPlain, kShareRange},
    {"std", [](const P& p) { return p.spatial.lay; }, G::kAxis, {0.0, 180.0}},
    {"ssw", [](const P& p) { return p.spatial.ssw; }, G::kPlain, kFromZero},
    {"sdq", [](const P& p) { return p.sdq; }, G::kSquare, kFromZero},
    {"sdr", [](const P& p) { return p.sdr; }, G::kCurved, kFromZero},
    {"sk", [](const P& p) { return p.ratio.sk; }, G::kRank, kFromZero},
    {"spk", [](const P& p) { return p.ratio.spk; }, G::kRank, kFromZero},
    {"svk", [](const P& p) { return p.ratio.svk; }, G::kRank, kFromZero},
    {"smrk1", [](const P& p) { return p.ratio.smrk1; }, G::kShare, kShareRange},
    {"smrk2", [](const P& p) { return p.ratio.smrk2; }, G::kShare, kShareRange},
    {"vmp", [](const P& p) { return p.ratio.vmp; }, G::kRank, kFromZero},
    {"vmc", [](const P& p) { return p.ratio.vmc; }, G::kRank, kFromZero},
    {"vvc", [](const P& p) { return p.ratio.vvc; }, G::kRank, kFromZero},
    {"vvv", [](const P& p) { return p.ratio.vvv; }, G::kRank, kFromZero},
    {"sxp", [](const P& p) { return p.ratio.sxp; }, G::kRank, kFromZero},
    {"spd", [](const P& p) { return p.feature.spd; }, G::kPlaces, kFromZero},
    {"svd", [](const P& p) { return p.feature.svd; }, G::kPlaces, kFromZero},
    {"spc", [](const P& p) { return p.feature.spc; }, G::kPlaces, kFromZero},
    {"svc", [](const P& p) { return p.feature.svc; }, G::kPlaces, kFromZero},
    {"s5p", [](const P& p) { return p.feature.s5p; }, G::kExtreme, kFromZero},
    {"s5v", [](const P& p) { return p.feature.s5v; }, G::kExtreme, kFromZero},
    {"s10z", [](const P& p) { return p.feature.s10z; }, G::kExtreme, kFromZero},
    {"sha", [](const P& p) { return p.feature.sha; }, G::kPlaces, kFromZero},
    {"sda", [](const P& p) { return p.feature.sda; }, G::kPlaces, kFromZero},
    {"shv", [](const P& p) { return p.feature.shv; }, G::kPlaces, kFromZero},
    {"sdv", [](const P& p) { return p.feature.sdv; }, G::kPlaces, kFromZero},
};

}  // namespace

std::span<const ArealFigure> arealFigures() noexcept {
  return kFigures;
}

const ArealFigure& arealFigure(std::string_view key) noexcept {
  const auto* const found =
      std::ranges::find_if(kFigures, [key](const ArealFigure& figure) { return figure.key == key; });
  assert(found != std::end(kFigures));
  return *found;
}

std::vector<double> valuesOf(const ArealParameters& measured) {
  std::vector<double> values;
  for (const ArealFigure& figure : kFigures) values.push_back(figure.of(measured));
  values.insert(values.end(), measured.ratios.begin(), measured.ratios.end());
  values.insert(values.end(), measured.heights.begin(), measured.heights.end());
  return values;
}

std::vector<NoiseGrowth> growthsOf(const ArealParameters& measured) {
  std::vector<NoiseGrowth> growths;
  for (const ArealFigure& figure : kFigures) growths.push_back(figure.growth);
  growths.resize(growths.size() + measured.ratios.size() + measured.heights.size(), NoiseGrowth::kShare);
  return growths;
}

void keepWithinRanges(std::span<NoiseEffect> effects, const ArealParameters& measured) {
  const std::vector<double> found = valuesOf(measured);
  std::vector<FigureRange> ranges;
  for (const ArealFigure& figure : kFigures) ranges.push_back(figure.range);
  ranges.resize(ranges.size() + measured.ratios.size(), kShareRange);
  ranges.resize(found.size());  // heights have any
  for (std::size_t i = 0; i < found.size(); ++i) effects[i] = withinRange(effects[i], found[i], ranges[i]);
  // Where noise decides how many hills there are it decides how large they are.
  const auto indexOf = [](std::string_view key) {
    return static_cast<std::size_t>(&arealFigure(key) - kFigures);
  };
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [size, density] :
       {std::pair{"sha", "spd"}, {"shv", "spd"}, {"sda", "svd"}, {"sdv", "svd"}})
    if (std::isnan(effects[indexOf(density)].without) && !std::isnan(effects[indexOf(size)].without))
      effects[indexOf(size)] = {kNone, kNone, "noise changes how many there are"};
}

void addDominanceDoubt(std::span<NoiseEffect> effects, const NoiseModel& noise,
                       const ArealParameters& measured) {
  // The share's square in place of it: next to nothing of noise that is below a third of the surface.
  const double share = noise.sigma / measured.sq;
  if (measured.sq > 0.0) addRankDoubt(effects, growthsOf(measured), share * share);
}

ArealOptions optionsOf(ArealOptions options, TrialNoise noise) {
  if (noise == TrialNoise::kLouder) options.spatial = options.feature = false;
  return options;
}

Result<std::vector<NoiseEffect>> arealEffects(const Version& field, const NoiseModel& noise,
                                              const ArealParameters& measured, const ArealTrialOf& measure,
                                              const NoiseTrialOptions& options, JobControl& job) {
  const std::vector<double> found = valuesOf(measured);
  const std::vector<NoiseGrowth> growths = growthsOf(measured);
  auto effects = noiseEffects(
      field, noise, found, growths,
      [&](const Version& noisy, TrialNoise of) -> Result<std::vector<double>> {
        const auto again = measure(noisy, of);
        if (!again) return tl::unexpected(again.error());
        return valuesOf(*again);
      },
      options, job);
  if (effects) addDominanceDoubt(*effects, noise, measured);
  if (effects) keepWithinRanges(*effects, measured);
  return effects;
}

}  // namespace fettle::engine
