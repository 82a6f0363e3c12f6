#include "app/commands/noise_option.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "app/terminal.h"
#include "engine/inspect/noise_model.h"
#include "engine/uncertainty/areal_figures.h"
#include "engine/uncertainty/part_effects.h"

namespace fettle::app {

namespace {

constexpr int kMostTrials = 16, kFewestTrials = 4;
constexpr std::int64_t kTrialSamples = std::int64_t{4} << 20;

}  // namespace

int noiseTrials(int trials, std::int64_t samples) noexcept {
  if (trials != kUsualTrials) return trials;
  const auto fit = static_cast<int>(
      std::min<std::int64_t>(kMostTrials, kTrialSamples / std::max<std::int64_t>(samples, 1)));
  return fit < kFewestTrials ? 0 : fit - fit % 2;
}

void addNoiseOption(Command command, int& trials) {
  command.add(
      {{.name = "--noise-trials",
        .to = &trials,
        .text =
            "Measure so often with the scan's own noise added, for each parameter without noise and its "
            "standard error: an even number, 4 or more, as a noise and its opposite make a pair; 0: leave "
            "these out",
        .range = Range{0.0, 1000.0},
        .otherwise = "as many as measure 4 million samples, 16 at most; of more than 1 million 4 on a part "
                     "that stands for all"}});
}

engine::Status checkNoiseTrials(int trials) {
  if (trials == kUsualTrials || trials == 0 || (trials >= kFewestTrials && trials % 2 == 0)) return {};
  return engine::inputError(
      fmt::format("{} trials are not possible: a noise and its opposite make a pair", trials),
      "--noise-trials", "give 0, or an even number from 4 on");
}

engine::Result<std::optional<ArealNoise>> arealNoise(const engine::Version& field,
                                                     const engine::ArealParameters& measured,
                                                     const ArealOf& measure, int trials,
                                                     engine::JobControl& job) {
  const std::int64_t samples = static_cast<std::int64_t>(field.grid().width) * field.grid().height;
  const int wanted = noiseTrials(trials, samples);
  if (wanted == 0) {
    if (trials == kUsualTrials)
      note(fmt::format(
          "the effect of noise is left out for {} samples; --noise-trials 4 measures it in five times "
          "the time",
          samples));
    return std::optional<ArealNoise>();
  }
  const auto noise = engine::measureNoise(field, job);
  if (!noise) return tl::unexpected(noise.error());
  if (std::isnan(noise->sigma)) return std::optional<ArealNoise>();
  // What the command has said of the scan is not said again of each trial.
  const KeptMessages said;
  const int pairs = wanted / 2;
  auto effects = engine::arealEffects(field, *noise, measured, measure, {.pairs = pairs}, job);
  if (!effects) return tl::unexpected(effects.error());
  return ArealNoise{noise->sigma, 2 * pairs, *std::move(effects)};
}

engine::Result<std::optional<PartNoise>> arealNoiseOfPart(
    const engine::Version& field, const engine::Version& surface, const engine::ArealParameters& measured,
    const engine::ArealOptions& options, const SurfaceOf& surface_of, engine::JobControl& job) {
  const auto noise = engine::measureNoise(field, job);
  if (!noise) return tl::unexpected(noise.error());
  if (std::isnan(noise->sigma)) return std::optional<PartNoise>();
  const KeptMessages said;
  const engine::PartOptions how;
  auto part = engine::arealEffectsOfPart(field, *noise, surface, measured, options, surface_of, how, job);
  if (!part) return tl::unexpected(part.error());
  return PartNoise{{noise->sigma, 2 * how.pairs, std::move(part->effects)}, part->samples};
}

}  // namespace fettle::app
