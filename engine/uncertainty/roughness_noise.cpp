#include "engine/uncertainty/roughness_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "engine/scanner/counter_random.h"

namespace fettle::engine {

namespace {

// A profile has some hundred ranks, of which noise chooses other ones for the equivalent line than its trials do: without this
// 53 to 59 % of 1,000 simulated profiles of 250 places and little noise lie within one error of the truth, with it 65 and more
// (uncertainty_test --gtest_filter='RoughnessNoise.*', FETTLE_NOISE_SEEDS=1000).
constexpr double kFewRanks = 1.3;

// Noise that splits elements of the profile, or joins them, makes others of it, which trials around the scan do not undo: Rc without noise
// was up to 26 % too large then, and half of the raise or less off where its elements stay (docs/decisions/parameter-errors.md). Shares of Rc, and of
// RSm, up to which they stay.
constexpr double kMostOfElements = 0.03, kMostOfWidths = 0.02;

// The variance of offsets is known to so much of itself, over the root of how many lines a field has (engine/inspect/noise_lines.h).
constexpr double kLinesScatter = 2.3;

// Share of the profile's mean square. Of simulated rows that were off by as much as the surface's Rq RSm was half as large as without, and
// its error a fifth of what it was off; with less than a third of the mean square it was covered.
constexpr double kMostOfProfile = 0.33;

NoiseGrowth growthOf(const RoughnessInfo& info) {
  // The greatest of many, or what such a one decides.
  for (const auto figure : {&Roughness::rz, &Roughness::rzx, &Roughness::rp, &Roughness::rv, &Roughness::rt,
                            &Roughness::rc, &Roughness::rsm})
    if (info.figure == figure) return NoiseGrowth::kExtreme;
  for (const auto figure : {&Roughness::rk, &Roughness::rpk, &Roughness::rvk})
    if (info.figure == figure) return NoiseGrowth::kRank;
  if (info.unit == RoughnessInfo::Unit::kRatio) return NoiseGrowth::kShare;
  const bool square = info.unit == RoughnessInfo::Unit::kHeight || info.figure == &Roughness::rdq;
  return square ? NoiseGrowth::kSquare : NoiseGrowth::kPlain;
}

FigureRange rangeOf(const RoughnessInfo& info) {
  if (info.unit == RoughnessInfo::Unit::kRatio) return {0.0, 1.0};
  if (info.figure == &Roughness::rsk) return {};
  return {.low = info.figure == &Roughness::rku ? 1.0 : 0.0};
}

// All figures as numbers: those of roughnessInfos(), then what was asked for; and what each is.
std::vector<double> valuesOf(const Roughness& of) {
  std::vector<double> values;
  values.reserve(roughnessInfos().size() + of.ratios.size() + of.differences.size());
  for (const RoughnessInfo& info : roughnessInfos()) values.push_back(of.*info.figure);
  values.insert(values.end(), of.ratios.begin(), of.ratios.end());
  values.insert(values.end(), of.differences.begin(), of.differences.end());
  return values;
}
struct FigureKind {
  NoiseGrowth growth;
  FigureRange range;
};
std::vector<FigureKind> kindsOf(const Roughness& of) {
  std::vector<FigureKind> kinds;
  kinds.reserve(roughnessInfos().size() + of.ratios.size() + of.differences.size());
  for (const RoughnessInfo& info : roughnessInfos()) kinds.push_back({growthOf(info), rangeOf(info)});
  kinds.resize(kinds.size() + of.ratios.size(), {NoiseGrowth::kShare, {0.0, 1.0}});
  kinds.resize(kinds.size() + of.differences.size(), {NoiseGrowth::kRank, {.low = 0.0}});
  return kinds;
}

const NoiseEffect& effectOf(double Roughness::*figure, const RoughnessNoise& noise) {
  const std::span<const RoughnessInfo> infos = roughnessInfos();
  return noise[static_cast<std::size_t>(std::ranges::find(infos, figure, &RoughnessInfo::figure) -
                                        infos.begin())];
}

// The lower factor of the covariance: row i holds those of places i - band + 1 .. i. A place whose variance is in those
// before it, as of two places at one sample, gets none of its own.
std::vector<double> factorOf(const Section& section) {
  const auto band = static_cast<std::size_t>(section.band);
  const std::size_t n = section.size();
  std::vector<double> factor(n * band);
  const auto at = [&](std::size_t i, std::size_t j) -> double& {
    return factor[i * band + (j + band - 1 - i)];
  };
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t first = i + 1 >= band ? i + 1 - band : 0;
    const double variance = section.covariance[i * band];
    for (std::size_t j = first; j <= i; ++j) {
      double sum = section.covariance[j * band + (i - j)];
      for (std::size_t k = first; k < j; ++k) sum -= at(i, k) * at(j, k);
      if (j == i)
        at(i, i) = sum > 1e-9 * variance ? std::sqrt(sum) : 0.0;
      else
        at(i, j) = at(j, j) > 0.0 ? sum / at(j, j) : 0.0;
    }
  }
  return factor;
}

// Noise of samples alone.
void addOfSamples(std::vector<double>& noise, const Section& section, const std::vector<double>& factor,
                  double sample_mm, std::uint64_t seed) {
  const CounterRandom random(seed, 3);
  const auto band = static_cast<std::size_t>(section.band);
  std::vector<double> own(section.size());
  for (std::size_t i = 0; i < own.size(); ++i) own[i] = random.normal(static_cast<std::int32_t>(i), 0);
  for (std::size_t i = 0; i < own.size(); ++i)
    for (std::size_t j = i + 1 >= band ? i + 1 - band : 0; j <= i; ++j)
      noise[i] += sample_mm * factor[i * band + (j + band - 1 - i)] * own[j];
}

// Offsets of all rows and columns of the field, of independent size.
Section::LineOffsets drawnOffsets(const Grid& grid, const SectionNoise& noise, std::uint64_t seed) {
  Section::LineOffsets off;
  const auto draw = [&](std::vector<double>& of, double size, std::int32_t lines, std::uint64_t stream) {
    if (!(size > 0.0)) return;
    const CounterRandom random(seed, stream);
    for (std::int32_t i = 0; i < lines; ++i) of.push_back(size * random.normal(i, 0));
  };
  draw(off.rows, noise.rows_mm, grid.height, 4);
  draw(off.columns, noise.columns_mm, grid.width, 5);
  return off;
}

// Noise of a section, a row for each draw.
struct DrawnNoise {
  std::vector<std::vector<double>> heights;
  double doubt = 0.0;  // share of its variance about its mean that is not sure
};

double squareAboutMean(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double v : values) sum += v, squares += v * v;
  return squares - sum * sum / static_cast<double>(std::max<std::size_t>(values.size(), 1));
}

DrawnNoise drawnNoise(const Section& section, const SectionNoise& noise, std::uint64_t seed, int draws) {
  DrawnNoise drawn;
  drawn.heights.assign(static_cast<std::size_t>(draws), std::vector<double>(section.size(), 0.0));
  double of_lines = 0.0;
  const bool off = noise.rows_mm > 0.0 || noise.columns_mm > 0.0;
  if (off && !section.source.field.empty()) {
    const Grid& grid = section.source.field.grid();
    std::vector<Section::LineOffsets> offsets;
    offsets.reserve(static_cast<std::size_t>(draws));
    for (int k = 0; k < draws; ++k)
      offsets.push_back(drawnOffsets(grid, noise, seed + static_cast<std::uint64_t>(k)));
    drawn.heights = section.offBy(offsets);
    for (const std::vector<double>& heights : drawn.heights) of_lines += squareAboutMean(heights);
  }
  const std::vector<double> factor = factorOf(section);
  for (std::size_t k = 0; k < drawn.heights.size(); ++k)
    addOfSamples(drawn.heights[k], section, factor, noise.sample_mm, seed + k);
  if (of_lines > 0.0) {
    double all = 0.0;
    for (const std::vector<double>& heights : drawn.heights) all += squareAboutMean(heights);
    const Grid& grid = section.source.field.grid();
    const double rows = noise.rows_mm * noise.rows_mm, columns = noise.columns_mm * noise.columns_mm;
    const double known =
        (rows * kLinesScatter / std::sqrt(grid.height) + columns * kLinesScatter / std::sqrt(grid.width)) /
        (rows + columns);
    drawn.doubt = known * std::min(1.0, of_lines / all);
  }
  return drawn;
}

}  // namespace

std::vector<std::vector<double>> sectionNoise(const Section& section, const SectionNoise& noise,
                                              std::uint64_t seed, int draws) {
  return drawnNoise(section, noise, seed, draws).heights;
}

Result<RoughnessNoise> roughnessNoise(const Section& section, const Stretch& within,
                                      const ProfileFilters& filters, const Roughness& found,
                                      const SectionNoise& noise, const NoiseTrialOptions& options,
                                      const AskedRatios& asked) {
  const std::span<const RoughnessInfo> infos = roughnessInfos();
  const std::vector<double> values = valuesOf(found);
  const std::vector<FigureKind> kinds = kindsOf(found);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const bool known = !std::isnan(noise.sample_mm);
  RoughnessNoise result(
      values.size(),
      {kNone, kNone, known ? "the scan has no noise that was found" : "the noise of the scan is not known"});
  if (!known || !(noise.sample_mm > 0.0 || noise.rows_mm > 0.0 || noise.columns_mm > 0.0)) return result;
  const DrawnNoise drawn = drawnNoise(section, noise, options.seed, options.pairs);
  std::vector<std::vector<TrialPair>> pairs(values.size());
  Section noisy = section;
  for (const std::vector<double>& more : drawn.heights) {
    std::vector<double> sides[2];
    for (int side = 0; side < 2; ++side) {
      for (std::size_t i = 0; i < more.size(); ++i)
        noisy.height[i] = section.height[i] + (side == 0 ? more[i] : -more[i]);
      const auto rough = roughnessOf(noisy, within, filters, asked);
      if (!rough) return tl::unexpected(rough.error());
      sides[side] = valuesOf(*rough);
    }
    for (std::size_t f = 0; f < values.size(); ++f) pairs[f].push_back({sides[0][f], sides[1][f]});
  }
  std::vector<NoiseGrowth> growth;
  growth.reserve(kinds.size());
  for (std::size_t f = 0; f < values.size(); ++f) {
    growth.push_back(kinds[f].growth);
    result[f] = noiseEffectOf(values[f], pairs[f], growth.back(), {.doubt = drawn.doubt});
    if (growth.back() == NoiseGrowth::kRank || growth.back() == NoiseGrowth::kShare)
      result[f].error *= kFewRanks;
  }
  // The noise in the profile over its heights: what the trials took off Rq by square, which lanes and filters have made smaller.
  const double less = effectOf(&Roughness::rq, result).without / found.rq;
  const double share = std::isnan(less) ? 0.0 : std::sqrt(std::max(0.0, 1.0 - less * less));
  addRankDoubt(result, growth, share);
  const auto rc = static_cast<std::size_t>(std::ranges::find(infos, &Roughness::rc, &RoughnessInfo::figure) -
                                           infos.begin());
  const NoiseEffect& widths = effectOf(&Roughness::rsm, result);
  const bool same_elements = std::abs(widths.without - found.rsm) <= kMostOfWidths * found.rsm &&
                             widths.error <= kMostOfWidths * found.rsm;
  if (!std::isnan(result[rc].without) &&
      !(same_elements && std::abs(result[rc].without - found.rc) <= kMostOfElements * found.rc))
    result[rc] = {kNone, kNone, "noise changes the elements of the profile"};
  // Trials around a profile that is mostly noise change its elements and its shape no more.
  if (share * share > kMostOfProfile)
    for (const auto figure : {&Roughness::rsm, &Roughness::rsk, &Roughness::rku}) {
      const auto at =
          static_cast<std::size_t>(std::ranges::find(infos, figure, &RoughnessInfo::figure) - infos.begin());
      if (!std::isnan(result[at].without))
        result[at] = {kNone, kNone, "the profile is noise for the most part"};
    }
  // A size with an error as large as itself, and a share with one larger than that of all shares alike, are not determined.
  for (std::size_t f = 0; f < values.size(); ++f) {
    const double most = growth[f] == NoiseGrowth::kShare  ? 1.0 / std::sqrt(12.0)
                        : growth[f] == NoiseGrowth::kRank ? values[f]
                                                          : std::numeric_limits<double>::infinity();
    // A waviness has a few waves of the smoothest kind: the equivalent line goes from some ranks of theirs to others, which trials do not see
    // (of 40 simulated ones 6 to 25 lie within one error).
    const bool ranks = growth[f] == NoiseGrowth::kShare || growth[f] == NoiseGrowth::kRank;
    if (ranks && filters.kind == ProfileKind::kWaviness)
      result[f] = {kNone, kNone, "trials do not see how ranks of a few smooth waves change"};
    else if (result[f].error > most)
      result[f] = {kNone, kNone,
                   growth[f] == NoiseGrowth::kShare
                       ? "noise leaves it open: its error would be that of any share"
                       : "noise leaves it open: its error would be as large as itself"};
    result[f] = withinRange(result[f], values[f], kinds[f].range);
  }
  return result;
}

}  // namespace fettle::engine
