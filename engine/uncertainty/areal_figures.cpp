#include "engine/uncertainty/areal_figures.h"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace fettle::engine {

namespace {

using P = ArealParameters;
using G = NoiseGrowth;

constexpr ArealFigure kFigures[] = {
    {"sq", [](const P& p) { return p.sq; }, G::kSquare},
    {"ssk", [](const P& p) { return p.ssk; }, G::kPlain},
    {"sku", [](const P& p) { return p.sku; }, G::kPlain},
    {"sp", [](const P& p) { return p.sp; }, G::kExtreme},
    {"sv", [](const P& p) { return p.sv; }, G::kExtreme},
    {"sz", [](const P& p) { return p.sz; }, G::kExtreme},
    {"sa", [](const P& p) { return p.sa; }, G::kSquare},
    {"sal", [](const P& p) { return p.spatial.sal; }, G::kPlain},
    {"str", [](const P& p) { return p.spatial.str; }, G::kPlain},
    {"std", [](const P& p) { return p.spatial.lay; }, G::kAxis},
    {"sdq", [](const P& p) { return p.sdq; }, G::kSquare},
    {"sdr", [](const P& p) { return p.sdr; }, G::kPlain},
    {"sk", [](const P& p) { return p.ratio.sk; }, G::kRank},
    {"spk", [](const P& p) { return p.ratio.spk; }, G::kRank},
    {"svk", [](const P& p) { return p.ratio.svk; }, G::kRank},
    {"smrk1", [](const P& p) { return p.ratio.smrk1; }, G::kShare},
    {"smrk2", [](const P& p) { return p.ratio.smrk2; }, G::kShare},
    {"vmp", [](const P& p) { return p.ratio.vmp; }, G::kRank},
    {"vmc", [](const P& p) { return p.ratio.vmc; }, G::kRank},
    {"vvc", [](const P& p) { return p.ratio.vvc; }, G::kRank},
    {"vvv", [](const P& p) { return p.ratio.vvv; }, G::kRank},
    {"sxp", [](const P& p) { return p.ratio.sxp; }, G::kRank},
    {"spd", [](const P& p) { return p.feature.spd; }, G::kPlaces},
    {"spc", [](const P& p) { return p.feature.spc; }, G::kPlaces},
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

Result<std::vector<NoiseEffect>> arealEffects(
    const Version& field, const NoiseModel& noise, const ArealParameters& measured,
    const std::function<Result<ArealParameters>(const Version&)>& measure, const NoiseTrialOptions& options,
    JobControl& job) {
  const std::vector<double> found = valuesOf(measured);
  const std::vector<NoiseGrowth> growths = growthsOf(measured);
  auto effects = noiseEffects(
      field, noise, found, growths,
      [&](const Version& noisy) -> Result<std::vector<double>> {
        const auto again = measure(noisy);
        if (!again) return tl::unexpected(again.error());
        return valuesOf(*again);
      },
      options, job);
  if (effects && measured.sq > 0.0) addRankDoubt(*effects, growths, noise.sigma / measured.sq);
  return effects;
}

}  // namespace fettle::engine
