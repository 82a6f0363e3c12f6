#pragma once

#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "engine/measure/areal.h"
#include "engine/uncertainty/noise_trial.h"

namespace fettle::engine {

/// A parameter of measureAreal() as a number, and how noise raises it.
struct ArealFigure {
  std::string_view key;  ///< "sq"; that of ArealParameters::NotStated too
  double (*of)(const ArealParameters&);
  NoiseGrowth growth;
  FigureRange range;
};
/// That of a key that there is.
[[nodiscard]] const ArealFigure& arealFigure(std::string_view key) noexcept;
/// All of them.
[[nodiscard]] std::span<const ArealFigure> arealFigures() noexcept;
/// Their values, followed by what was asked for: the ratios, the heights, the material volumes, the void volumes and the height differences; and
/// how noise raises each of these.
[[nodiscard]] std::vector<double> valuesOf(const ArealParameters& measured);
[[nodiscard]] std::vector<NoiseGrowth> growthsOf(const ArealParameters& measured);

/// withinRange() of each effect on what was found in valuesOf(): no figure with an error that leaves it open, and no size of hills or dales whose number noise
/// leaves open.
void keepWithinRanges(std::span<NoiseEffect> effects, const ArealParameters& measured);

/// Adds to the errors of ranks, and of Sa, what nothing says of them where noise is as large as the surface, and takes away means of
/// five extremes where noise of 0.15 of Sq and more decides which hills are the highest, and Str where noise decides which direction decays last.
void addDominanceDoubt(std::span<NoiseEffect> effects, const NoiseModel& noise,
                       const ArealParameters& measured);

/// Whether a texture direction [degrees] is within 3 degrees of rows, or of columns, that are off together: these draw it to themselves.
[[nodiscard]] bool liesAlongLines(const NoiseModel& noise, double lay_deg) noexcept;

/// Measures the parameters of a field; of TrialNoise::kLouder spatial and feature parameters do not count.
using ArealTrialOf = std::function<Result<ArealParameters>(const Version& field, TrialNoise noise)>;

/// `options` as far as such a trial needs them.
[[nodiscard]] ArealOptions optionsOf(ArealOptions options, TrialNoise noise);

/// noiseEffects() of the parameters of a field, with addDominanceDoubt() and keepWithinRanges(). `measure` measures them of a field as `measured` was.
/// Where whole rows or columns are off it does so once more, with such offsets in the other direction: Std and Ssw that these change are not stated, nor is Std along lines that are off (liesAlongLines()).
[[nodiscard]] Result<std::vector<NoiseEffect>> arealEffects(const Version& field, const NoiseModel& noise,
                                                            const ArealParameters& measured,
                                                            const ArealTrialOf& measure,
                                                            const NoiseTrialOptions& options,
                                                            JobControl& job);

}  // namespace fettle::engine
