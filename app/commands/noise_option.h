#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "app/commands/command.h"
#include "app/work/areal_table.h"
#include "engine/base/error.h"
#include "engine/field/version.h"
#include "engine/measure/areal.h"
#include "engine/uncertainty/areal_figures.h"

namespace fettle::app {

/// --noise-trials. Without it as many as measure 4 million samples, 16 at most; where that is less than 4 none, or of a part.
void addNoiseOption(Command command, int& trials);
/// Its value where it is not given.
inline constexpr int kUsualTrials = -1;

/// Refuses what are no pairs: 1, 2 and odd numbers.
[[nodiscard]] engine::Status checkNoiseTrials(int trials);

/// How many are made of a field of so many samples where `trials` was given, or kUsualTrials.
[[nodiscard]] int noiseTrials(int trials, std::int64_t samples) noexcept;

/// Measures the parameters of a field as the command did, with all that it does before.
using ArealOf = engine::ArealTrialOf;

/// What the noise of `field`, of which `measured` was measured by `measure`, does to the parameters; none where no trials are made, which a
/// note on stderr says unless that was asked for, or where the field has no noise that can be measured. The field that the noise is measured of and added to is the
/// scan's, before filters and form. Errors: those of measureNoise and noiseEffects.
[[nodiscard]] engine::Result<std::optional<ArealNoise>> arealNoise(const engine::Version& field,
                                                                   const engine::ArealParameters& measured,
                                                                   const ArealOf& measure, int trials,
                                                                   engine::JobControl& job);

/// The same by 4 trials on a part of the field (engine::arealEffectsOfPart), whose time no size of the field changes. `surface` is what was
/// measured, with holes where no sample counts; `surface_of` makes it of a piece of the field.
struct PartNoise {
  ArealNoise noise;
  std::int64_t samples = 0;  ///< of the part, with a height
};
using SurfaceOf = std::function<engine::Result<engine::Version>(const engine::Version& piece)>;
[[nodiscard]] engine::Result<std::optional<PartNoise>> arealNoiseOfPart(
    const engine::Version& field, const engine::Version& surface, const engine::ArealParameters& measured,
    const engine::ArealOptions& options, const SurfaceOf& surface_of, engine::JobControl& job);

}  // namespace fettle::app
