#include "engine/uncertainty/noise_trial.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <new>

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
  double doubt;    // share of the raise that is not sure
  double scatter;  // that counts, over the scatter of the trials
  double most;     // raise over the figure, beyond which it is not decided
};
constexpr double kMostError =
    0.5;  // over the figure, beyond which one with a limit of the raise is not decided either
constexpr double kAny = std::numeric_limits<double>::infinity();
constexpr GrowthRule kRules[] = {
    {true, 0.2, 1.0, kAny},    // kSquare
    {false, 0.2, 1.0, kAny},   // kPlain
    {false, 0.2, 1.0, kAny},   // kAxis
    {true, 0.5, 1.25, kAny},   // kRank
    {false, 0.5, 1.25, kAny},  // kShare
    {true, 0.7, 1.25, kAny},   // kExtreme
    {true, 3.0, 1.25, 0.2},    // kPlaces
};
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
                       double share) {
  if (std::isnan(found) || std::isnan(of_part)) return {kNone, kNone};
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
  const double doubt = std::hypot(rule.doubt, unlike) * raise, by_trials = widened * widened;
  const double error = std::sqrt(by_trials * (share * scatter + spread * (share + 1.0 / n)) + doubt * doubt);
  double without = whole - raise;
  if (!rule.by_square) {
    if (growth == NoiseGrowth::kAxis) without -= 180.0 * std::floor(without / 180.0);
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

NoiseEffect noiseEffectOf(double found, std::span<const TrialPair> pairs, NoiseGrowth growth) {
  return effectFrom(found, found, pairs, growth, 1.0);
}

NoiseEffect partEffectOf(double found, double of_part, std::span<const TrialPair> pairs, NoiseGrowth growth,
                         double share) {
  return effectFrom(found, of_part, pairs, growth, share);
}

Result<std::vector<NoiseEffect>> noiseEffects(const Version& field, const NoiseModel& noise,
                                              std::span<const double> found,
                                              std::span<const NoiseGrowth> growth, const FiguresOf& measure,
                                              const NoiseTrialOptions& options, JobControl& job) {
  std::vector<std::vector<TrialPair>> pairs(found.size());
  for (int k = 0; k < options.pairs; ++k) {
    const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(k);
    const auto draw = NoiseDraw::create(field.grid(), noise, seed);
    if (!draw) return tl::unexpected(draw.error());
    std::vector<double> sides[2];
    for (int side = 0; side < 2; ++side) {
      const auto noisy = draw->addedTo(field, noise, side == 0 ? 1.0 : -1.0, job);
      if (!noisy) return tl::unexpected(noisy.error());
      auto figures = measure(*noisy);
      if (!figures) return tl::unexpected(figures.error());
      sides[side] = *std::move(figures);
    }
    for (std::size_t i = 0; i < found.size(); ++i) pairs[i].push_back({sides[0][i], sides[1][i]});
  }
  std::vector<NoiseEffect> effects;
  effects.reserve(found.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    effects.push_back(noiseEffectOf(found[i], pairs[i], growth[i]));
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
