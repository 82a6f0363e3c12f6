#include "engine/uncertainty/areal_figures.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>

#include "engine/uncertainty/direction_noise.h"

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

// Noise over Sq from which on its hills are taken for the highest.
constexpr double kOtherHills = 0.15;

// Of what Str would be without noise, over what it is: beyond this another direction, or another wave, decays last.
constexpr double kOtherDecay = 0.1;

// Standard deviation of what noise scatters the autocorrelation by, as a share of the level of decay: the mean of noise times heights a lag
// away on both sides, 2 noise / (Sq sqrt(samples)) at most, over 0.2.
double decayScatter(const NoiseModel& noise, const ArealParameters& measured) noexcept {
  constexpr double kLevel = 0.2;
  return 2.0 * noise.sigma / (kLevel * measured.sq * std::sqrt(static_cast<double>(measured.samples)));
}

// Whether noise decides Str: where a level of decay that is lower by as much as noise lowers the autocorrelation, and by three standard deviations
// of what it scatters that, is reached elsewhere. Trials do not see it, since more noise does not lead back.
bool noiseDecidesDecay(const NoiseModel& noise, const ArealParameters& measured) noexcept {
  const double share = noise.sigma * noise.sigma / (measured.sq * measured.sq);
  const double lowered = share + 3.0 * decayScatter(noise, measured);
  for (std::size_t k = 0; k < SpatialParameters::kLowered.size(); ++k) {
    if (!(std::abs(measured.spatial.str_lowered[k] - 1.0) <= kOtherDecay)) return true;
    if (SpatialParameters::kLowered[k] >= lowered) return false;
  }
  return false;
}

// Where the autocorrelation falls slowly around its level a few trials say by chance little or much of what noise moves and scatters Str by, and
// where it bends not where Str comes from. Both follow from Str at lower levels, too: the error is no less than what a standard deviation of the
// autocorrelation's scatter moves it by, and has in it by how much both ways differ.
void addDecayDoubt(NoiseEffect& aspect, double heights_without, const NoiseModel& noise,
                   const ArealParameters& measured) {
  const SpatialParameters& spatial = measured.spatial;
  const double scattered = std::abs(spatial.strWithout(decayScatter(noise, measured)) - spatial.str);
  aspect.error = std::max(aspect.error, scattered);
  // Of what rows have in common not all is missing at a lag.
  const double left = heights_without / measured.sq,
               share = std::isnan(left) ? 0.0 : (1.0 - left * left) * noise.uncorrelatedShare();
  aspect.error = std::hypot(aspect.error, spatial.strWithout(share) - aspect.without);
}

// What lines share has all of its power in one direction, which a trial with as much of it again leaves as it is. Whether it decides the
// direction, and the strongest wave, is seen by what is off along rows added along columns, and the other way round: a surface whose own lay has less
// power than so much of the lines' variance loses its direction to that.
constexpr double kTurnedVariance = 4.0;
constexpr double kTurnedAway = 3.0;  // [degrees]
constexpr double kOtherWave = 0.03;  // share

Result<ArealParameters> measuredWithLinesTurned(const Version& field, const NoiseModel& noise,
                                                const ArealTrialOf& measure, const NoiseTrialOptions& options,
                                                JobControl& job) {
  NoiseModel turned;
  turned.parts.row_offset = kTurnedVariance * noise.whole_columns;
  turned.parts.column_offset = kTurnedVariance * noise.whole_rows;
  turned.sigma = std::sqrt(turned.parts.variance());
  const auto draw = NoiseDraw::create(field.grid(), turned, options.seed);
  if (!draw) return tl::unexpected(draw.error());
  const auto noisy = draw->addedTo(field, turned, 1.0, job);
  if (!noisy) return tl::unexpected(noisy.error());
  return measure(*noisy, TrialNoise::kOwn);
}

std::size_t indexOfFigure(std::string_view key) noexcept {
  return static_cast<std::size_t>(&arealFigure(key) - kFigures);
}

// Takes away what lines that are off decide.
Status leaveOutOfLines(std::span<NoiseEffect> effects, const Version& field, const NoiseModel& noise,
                       const ArealParameters& measured, const ArealTrialOf& measure,
                       const NoiseTrialOptions& options, JobControl& job) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  NoiseEffect &direction = effects[indexOfFigure("std")], &wave = effects[indexOfFigure("ssw")];
  if (!(noise.whole_rows > 0.0 || noise.whole_columns > 0.0)) return {};
  if (std::isnan(direction.without) && std::isnan(wave.without)) return {};
  const auto again = measuredWithLinesTurned(field, noise, measure, options, job);
  if (!again) return tl::unexpected(again.error());
  const double away = again->spatial.lay - measured.spatial.lay;
  // One along the lines that are off is drawn to them, and lines across it do not show that.
  if (!std::isnan(direction.without) && (liesAlongLines(noise, measured.spatial.lay) ||
                                         !(std::abs(away - 180.0 * std::round(away / 180.0)) <= kTurnedAway)))
    direction = {kNone, kNone, "its direction may be that of the lines that are off"};
  if (!std::isnan(wave.without) &&
      !(std::abs(again->spatial.ssw - measured.spatial.ssw) <= kOtherWave * measured.spatial.ssw))
    wave = {kNone, kNone, "its wave may be one of the lines that are off"};
  return {};
}

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

bool liesAlongLines(const NoiseModel& noise, double lay_deg) noexcept {
  return (noise.whole_rows > 0.0 && std::abs(lay_deg - 180.0 * std::round(lay_deg / 180.0)) < kTurnedAway) ||
         (noise.whole_columns > 0.0 && std::abs(lay_deg - 90.0) < kTurnedAway);
}

std::vector<double> valuesOf(const ArealParameters& measured) {
  std::vector<double> values;
  for (const ArealFigure& figure : kFigures) values.push_back(figure.of(measured));
  values.insert(values.end(), measured.ratios.begin(), measured.ratios.end());
  for (const std::vector<double>* const asked :
       {&measured.heights, &measured.material, &measured.voids, &measured.differences})
    values.insert(values.end(), asked->begin(), asked->end());
  return values;
}

std::vector<NoiseGrowth> growthsOf(const ArealParameters& measured) {
  std::vector<NoiseGrowth> growths;
  for (const ArealFigure& figure : kFigures) growths.push_back(figure.growth);
  growths.resize(growths.size() + measured.ratios.size() + measured.heights.size(), NoiseGrowth::kShare);
  // As Vmp, Vvv and Sxp, which are some of them.
  growths.resize(
      growths.size() + measured.material.size() + measured.voids.size() + measured.differences.size(),
      NoiseGrowth::kRank);
  return growths;
}

void keepWithinRanges(std::span<NoiseEffect> effects, const ArealParameters& measured) {
  const std::vector<double> found = valuesOf(measured);
  std::vector<FigureRange> ranges;
  for (const ArealFigure& figure : kFigures) ranges.push_back(figure.range);
  ranges.resize(ranges.size() + measured.ratios.size(), kShareRange);
  ranges.resize(ranges.size() + measured.heights.size());  // any
  ranges.resize(found.size(), kFromZero);
  for (std::size_t i = 0; i < found.size(); ++i) effects[i] = withinRange(effects[i], found[i], ranges[i]);
  // Where noise decides how many hills there are it decides how large they are.
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [size, density] :
       {std::pair{"sha", "spd"}, {"shv", "spd"}, {"sda", "svd"}, {"sdv", "svd"}})
    if (std::isnan(effects[indexOfFigure(density)].without) &&
        !std::isnan(effects[indexOfFigure(size)].without))
      effects[indexOfFigure(size)] = {kNone, kNone, "noise changes how many there are"};
}

void addDominanceDoubt(std::span<NoiseEffect> effects, const NoiseModel& noise,
                       const ArealParameters& measured) {
  // The share's square in place of it: next to nothing of noise that is below a third of the surface.
  const double share = noise.sigma / measured.sq;
  if (!(measured.sq > 0.0)) return;
  addRankDoubt(effects, growthsOf(measured), share * share);
  // What a parabola leaves of Sa of kinks and levels: 0.2 % with noise of 0.2, 0.6 % with 0.3.
  NoiseEffect& sa = effects[indexOfFigure("sa")];
  sa.error = std::hypot(sa.error, std::pow(share, 4) * sa.without);
  NoiseEffect& aspect = effects[indexOfFigure("str")];
  if (!std::isnan(aspect.without) && noiseDecidesDecay(noise, measured))
    aspect = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(),
              "noise decides which direction decays last"};
  if (!std::isnan(aspect.without))
    addDecayDoubt(aspect, effects[indexOfFigure("sq")].without, noise, measured);
  // Five highest peaks of hills that noise made are others' (0.6 of S5p is left on steps), and extremes say not how many.
  if (share < kOtherHills) return;
  const auto hillsChange = [&](std::string_view density) {
    return std::isnan(effects[indexOfFigure(density)].without);
  };
  const auto leaveOut = [&](std::string_view key, bool changes) {
    NoiseEffect& effect = effects[indexOfFigure(key)];
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    if (changes && !std::isnan(effect.without))
      effect = {kNone, kNone, "noise decides which hills are the highest"};
  };
  leaveOut("s5p", hillsChange("spd"));
  leaveOut("s5v", hillsChange("svd"));
  leaveOut("s10z", hillsChange("spd") || hillsChange("svd"));
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
  std::vector<SeenDirection> seen;  // one noise after the other, each with its opposite
  auto effects = noiseEffects(
      field, noise, found, growths,
      [&](const Version& noisy, TrialNoise of) -> Result<std::vector<double>> {
        const auto again = measure(noisy, of);
        if (!again) return tl::unexpected(again.error());
        if (of == TrialNoise::kOwn) seen.push_back(seenDirection(*again));
        return valuesOf(*again);
      },
      options, job);
  if (!effects) return effects;
  std::vector<DirectionPair> pairs;
  for (std::size_t k = 0; k + 1 < seen.size(); k += 2) pairs.push_back({seen[k], seen[k + 1]});
  const SeenDirection direction = seenDirection(measured);
  (*effects)[indexOfFigure("std")] = directionEffect(direction, direction, pairs, noise, 1.0);
  addDominanceDoubt(*effects, noise, measured);
  keepWithinRanges(*effects, measured);
  if (auto status = leaveOutOfLines(*effects, field, noise, measured, measure, options, job); !status)
    return tl::unexpected(status.error());
  return effects;
}

}  // namespace fettle::engine
