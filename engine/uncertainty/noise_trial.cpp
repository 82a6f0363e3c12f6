#include "engine/uncertainty/noise_trial.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <new>
#include <numbers>

#include "engine/field/tile.h"
#include "engine/measure/lowered.h"
#include "engine/suggest/noise_source.h"
#include "engine/uncertainty/part_effects.h"

namespace fettle::engine {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// What is known of each way to grow, in the order of the words. Shares and factors by simulation of known surfaces:
// docs/decisions/parameter-errors.md.
struct GrowthRule {
  bool by_square;
  double doubt;    // share of the raise that is not sure where its bend is not known
  double scatter;  // that counts, over the scatter of the trials
  double most;     // raise over the figure, beyond which it is not decided
  // Where the bend is known:
  bool taken_out = false;                // it is extrapolated
  double of_raise = 0.0, of_bend = 0.0;  // what extrapolation leaves open, over the raise and over the bend
};
constexpr double kMostError =
    0.5;  // over the figure, beyond which one with a limit of the raise is not decided either
constexpr double kAny = std::numeric_limits<double>::infinity();
constexpr GrowthRule kRules[] = {
    {true, 0.2, 1.0, kAny, true, 0.0, 0.6},     // kSquare
    {false, 0.2, 1.0, kAny, true, 0.0, 0.3},    // kCurved
    {false, 0.2, 1.0, kAny},                    // kPlain
    {false, 0.2, 1.4, kAny},                    // kAxis
    {true, 0.5, 1.4, kAny, false, 0.25, 2.5},   // kRank
    {false, 0.5, 1.4, kAny, false, 0.25, 2.5},  // kShare
    {true, 0.7, 1.25, kAny},                    // kExtreme
    {true, 3.0, 1.25, 0.2},                     // kPlaces
};
// Ranks of a rough curve bend by chance, by about as much as noise scatters them: so many of its squares are none of the extrapolation.
constexpr double kBendByChance = 2.0;
const GrowthRule& ruleOf(NoiseGrowth growth) noexcept {
  return kRules[static_cast<std::size_t>(growth)];
}

// The value of an axis nearest to another.
double nearestAxis(double degrees, double to) noexcept {
  return degrees + 180.0 * std::round((to - degrees) / 180.0);
}

double mean(std::span<const double> values) noexcept {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

// A figure as it grows with the variance of noise; an axis is taken near to `near`.
double grownBy(NoiseGrowth growth, double value, double near) noexcept {
  if (growth == NoiseGrowth::kAxis) return nearestAxis(value, near);
  return ruleOf(growth).by_square ? value * value : value;
}

// Of trials on a part of the surface whose own figure is `of_part`, which has `share` of the samples: all of it is the whole.
NoiseEffect effectFrom(double found, double of_part, std::span<const TrialPair> pairs, NoiseGrowth growth,
                       double share, const TrialKnowledge& known) {
  if (std::isnan(found)) return {kNone, kNone};
  if (std::isnan(of_part)) return {kNone, kNone, "the part for trials does not determine it"};
  const GrowthRule& rule = ruleOf(growth);
  if (rule.by_square && found < 0.0) return {kNone, kNone, "it is below 0"};  // its square says not which
  std::vector<double> halves, means;
  for (const TrialPair& pair : pairs) {
    const double more = grownBy(growth, pair.more, of_part), less = grownBy(growth, pair.less, of_part);
    if (std::isnan(more) || std::isnan(less)) continue;
    halves.push_back(0.5 * (more - less));
    means.push_back(0.5 * (more + less));
  }
  if (halves.size() < 2 || 4 * halves.size() < 3 * pairs.size())
    return {kNone, kNone, "with more noise it is not determined"};
  const auto n = static_cast<double>(halves.size());
  const double whole = grownBy(growth, found, found), part = grownBy(growth, of_part, of_part);
  const double middle = mean(means), raise = middle - part;
  double scatter = 0.0, spread = 0.0;
  for (std::size_t k = 0; k < halves.size(); ++k) {
    scatter += halves[k] * halves[k] / n;
    spread += (means[k] - middle) * (means[k] - middle) / (n - 1.0);
  }
  const double widened = rule.scatter * studentFactor(static_cast<int>(halves.size()));
  // As far as the part's figure is another one the raise may be, too.
  const double apart = growth == NoiseGrowth::kAxis ? nearestAxis(of_part, found) - found : part - whole;
  const double size = growth == NoiseGrowth::kAxis ? 90.0 : std::max(std::abs(part), std::abs(whole));
  const double unlike = size > 0.0 ? apart / size : 0.0;
  const double by_trials = widened * widened;
  // By the same noise, once and with twice its variance: what its own draw makes of a smooth figure is in neither.
  double bend = kNone;
  if (rule.of_bend > 0.0 && !std::isnan(pairs.front().more + pairs.front().less)) {
    const auto middleOf = [&](const TrialPair& pair) {
      return 0.5 * (grownBy(growth, pair.more, of_part) + grownBy(growth, pair.less, of_part));
    };
    bend = middleOf(known.louder) - 2.0 * middleOf(pairs.front()) + part;
  }
  double doubt = std::hypot(std::max(rule.doubt, known.doubt), unlike) * raise, without = whole - raise;
  if (!std::isnan(bend)) {
    const double by_chance = rule.taken_out ? 0.0 : kBendByChance * (scatter + spread * (1.0 + 1.0 / n));
    const double bends = rule.of_bend * std::sqrt(std::max(0.0, bend * bend - by_chance));
    doubt = std::hypot(std::hypot(known.doubt, rule.of_raise, unlike) * raise, bends);
    if (rule.taken_out) without += bend;
  }
  const double error = std::sqrt(by_trials * (share * scatter + spread * (share + 1.0 / n)) + doubt * doubt);
  if (!rule.by_square) {
    if (growth == NoiseGrowth::kAxis) {
      without -= 180.0 * std::floor(without / 180.0);
      if (!(without < 180.0)) without = 0.0;  // of a rounding below 0
    }
    return {without, error};
  }
  // The further of both ends of what the square may be; error / (2 without) where that is far from 0.
  without = std::sqrt(std::max(without, 0.0));
  if (std::abs(found - without) > rule.most * found)
    return {kNone, kNone, "noise changes it by more than a fifth"};
  const double square = without * without;
  // Rounding of the squares is no error: no trial changed the figure.
  if (error <= 1e-12 * square) return {without, 0.0};
  const double by = square > error ? without - std::sqrt(square - error)
                                   : std::max(without, std::sqrt(square + error) - without);
  if (by > kMostError * without && rule.most < kAny)
    return {kNone, kNone, "its error is more than half of it"};
  return {without, by};
}

}  // namespace

double sizeOf(TrialNoise noise) noexcept {
  return noise == TrialNoise::kLouder ? std::numbers::sqrt2 : 1.0;
}

Result<NoiseDraw> NoiseDraw::create(const Grid& grid, const NoiseModel& noise, std::uint64_t seed) try {
  NoiseDraw draw;
  draw.heights_ = NoiseSource(noise.parts).make(grid.width, grid.height, seed);
  return draw;
} catch (const std::bad_alloc&) {
  return failure("memory is exhausted", "measuring errors", "leave the errors out");
}

Result<Version> NoiseDraw::addedTo(const Version& field, const NoiseModel& noise, double sign,
                                   JobControl& job) const {
  const Grid& grid = field.grid();
  const double over = noise.sigma > 0.0 ? 1.0 / noise.sigma : 0.0;
  return lowered(
      field, "adding noise",
      [&](const SampleRect& rect, double* out) {
        for (std::int32_t r = 0; r < rect.rows; ++r)
          for (std::int32_t c = 0; c < rect.columns; ++c) {
            const std::int32_t column = rect.column + c, row = rect.row + r;
            const double share = noise.map.empty() ? 1.0 : noise.sigmaAt(grid, column, row) * over;
            out[r * kTileSide + c] =
                -sign * share *
                heights_[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.width) +
                         static_cast<std::size_t>(column)];
          }
      },
      job);
}

// Cornish and Fisher, 1937, of the quantile of Student's distribution at one standard deviation.
double studentFactor(int pairs) noexcept {
  const double n = std::max(pairs, 1);
  return 1.0 + 0.5 / n + 0.25 / (n * n);
}

double errorOfErrors(int pairs) noexcept {
  return 1.0 / std::sqrt(2.0 * std::max(pairs, 1));
}

NoiseEffect noiseEffectOf(double found, std::span<const TrialPair> pairs, NoiseGrowth growth,
                          const TrialKnowledge& known) {
  return effectFrom(found, found, pairs, growth, 1.0, known);
}

NoiseEffect partEffectOf(double found, double of_part, std::span<const TrialPair> pairs, NoiseGrowth growth,
                         double share, const TrialKnowledge& known) {
  return effectFrom(found, of_part, pairs, growth, share, known);
}

Result<std::vector<NoiseEffect>> noiseEffects(const Version& field, const NoiseModel& noise,
                                              std::span<const double> found,
                                              std::span<const NoiseGrowth> growth, const FiguresOf& measure,
                                              const NoiseTrialOptions& options, JobControl& job) {
  std::vector<std::vector<TrialPair>> pairs(found.size());
  std::vector<TrialPair> louder;
  for (int k = 0; k < options.pairs; ++k) {
    const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(k);
    const auto draw = NoiseDraw::create(field.grid(), noise, seed);
    if (!draw) return tl::unexpected(draw.error());
    const auto measured = [&](TrialNoise of, double sign) -> Result<std::vector<double>> {
      const auto noisy = draw->addedTo(field, noise, sign * sizeOf(of), job);
      if (!noisy) return tl::unexpected(noisy.error());
      return measure(*noisy, of);
    };
    for (const TrialNoise of : {TrialNoise::kOwn, TrialNoise::kLouder}) {
      if (of == TrialNoise::kLouder && k > 0) continue;
      const auto more = measured(of, 1.0), less = measured(of, -1.0);
      if (!more) return tl::unexpected(more.error());
      if (!less) return tl::unexpected(less.error());
      for (std::size_t i = 0; i < found.size(); ++i) {
        const TrialPair pair{(*more)[i], (*less)[i]};
        if (of == TrialNoise::kOwn)
          pairs[i].push_back(pair);
        else
          louder.push_back(pair);
      }
    }
  }
  std::vector<NoiseEffect> effects;
  effects.reserve(found.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    effects.push_back(noiseEffectOf(found[i], pairs[i], growth[i], {noise.doubt, louder[i]}));
  return effects;
}

NoiseEffect withinRange(const NoiseEffect& effect, double found, const FigureRange& range) {
  if (std::isnan(effect.without)) return effect;
  NoiseEffect result = effect;
  const double beyond = std::max(range.low - effect.without, effect.without - range.high);
  if (beyond > 2.0 * effect.error) return {kNone, kNone, "without noise it is a figure that cannot be"};
  if (beyond > 0.0) result.without = std::clamp(effect.without, range.low, range.high);
  const bool low = std::isfinite(range.low), high = std::isfinite(range.high);
  if (!std::isfinite(effect.error) || (low && high && effect.error > 0.5 * (range.high - range.low)))
    return {kNone, kNone, "its error is as large as its range"};
  if (low && !high && effect.error > std::max(found, result.without) - range.low)
    return {kNone, kNone, "its error is larger than it"};
  return result;
}

void addRankDoubt(std::span<NoiseEffect> effects, std::span<const NoiseGrowth> growth, double share) {
  for (std::size_t i = 0; i < effects.size(); ++i)
    if (growth[i] == NoiseGrowth::kRank || growth[i] == NoiseGrowth::kShare)
      effects[i].error = std::hypot(effects[i].error, 2.0 * share * share * effects[i].without);
}

}  // namespace fettle::engine
