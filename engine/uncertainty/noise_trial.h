#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/inspect/noise_model.h"

namespace fettle::engine {

// What the noise of a scan does to figures that are measured in it, by measuring the scan again with more noise like its
// own: simulation and extrapolation (J. Cook, L. Stefanski, Simulation-extrapolation estimation in parametric measurement error
// models, 1994; its error: L. Stefanski, J. Cook, Simulation-extrapolation: the measurement error jackknife, 1995).

/// How a figure follows the variance of the noise, which is what is extrapolated from twice the noise to none.
enum class NoiseGrowth : std::uint8_t {
  kSquare,   ///< its square rises with it: sizes of what is random, as heights and slopes
  kCurved,   ///< the figure itself, smoothly but not in proportion: skewness, kurtosis, area
  kPlain,    ///< the figure itself: ratios, lengths
  kAxis,     ///< an angle of half a turn [degrees], 0 .. 180
  kRank,     ///< by square, of ranks of heights: heights and volumes of the material ratio curve
  kShare,    ///< the figure itself, of ranks of heights: material ratios
  kExtreme,  ///< by square, the greatest of many samples
  kPlaces,   ///< by square, of single places that are chosen by their heights: peaks, hills
};

struct NoiseEffect {
  /// The figure without noise, estimated; NaN where the trials do not decide it.
  double without = 0.0;
  /// Its standard error by the noise of the scan; 0 where no trial changed it, NaN as `without`.
  double error = 0.0;
  std::string_view why =
      {};  ///< why there is none; empty where there is one, and of a figure that is not stated itself
};

/// The noise of a trial: the scan's own, or with twice its variance, which says how a figure bends on the way to no noise.
enum class TrialNoise : std::uint8_t { kOwn, kLouder };
/// Its standard deviation over that of the scan's own.
[[nodiscard]] double sizeOf(TrialNoise noise) noexcept;

struct NoiseTrialOptions {
  int pairs = 8;  ///< trials with a noise and with its opposite, at least 2
  std::uint64_t seed = 1;
};

/// Measures the figures of a field; as many each time, NaN for one that it does not determine. Of kLouder only those of kSquare, kCurved, kRank
/// and kShare count.
using FiguresOf = std::function<Result<std::vector<double>>(const Version& field, TrialNoise noise)>;

/// Noise of a model for each sample of a grid: drawn once, and added with both signs. Memory: 8 bytes per sample, 16 while it is drawn.
class NoiseDraw {
 public:
  /// The same bits for the same seed. Errors: kFailed without memory. Thread: any; on all workers of the arena.
  [[nodiscard]] static Result<NoiseDraw> create(const Grid& grid, const NoiseModel& noise,
                                                std::uint64_t seed);

  /// A field of that grid with the noise, `sign` (1 or -1) times, at every sample, as large at each place as the model's map
  /// says. Holes, marks, edge lines stay. Memory: a field's. Errors: kFailed without memory; kCancelled. Thread: any; a long job.
  [[nodiscard]] Result<Version> addedTo(const Version& field, const NoiseModel& noise, double sign,
                                        JobControl& job) const;

 private:
  std::vector<double> heights_;
};

/// By what the scatter of so many pairs is taken larger, so that one standard error covers 0.68 of normal figures: the
/// quantile of Student's distribution over the normal one, 1.31 of two pairs, 1.07 of eight.
[[nodiscard]] double studentFactor(int pairs) noexcept;
/// The standard error of a standard error that scatter of so many pairs alone makes, over it: 1 / sqrt(2 pairs), 0.5 of two, 0.25 of eight.
[[nodiscard]] double errorOfErrors(int pairs) noexcept;

/// The effect of the noise on each figure: `found` is what `measure` gave of `field`, `growth` as many.
///
/// Each trial adds noise of the model to the field, which then has twice its variance; a noise and its opposite give the part that noise
/// scatters (half their difference) and the part by which it raises the figure (their mean less that found), free of
/// the former. The figure without noise is what is found less that raise. Two more trials, with the first pair's noise of twice the variance, say how
/// the raise bends: of kSquare and kCurved the bend is taken out, too. The standard error is the root of the sum of squares of both
/// scatters, of what a few trials leave open, of NoiseModel::doubt times the raise, and of what the bend says of the extrapolation; of figures without
/// a bend (kPlain and after it but ranks) of a share of the raise for both (kRules in the source). What depends on ranks of heights scatters less around a surface that has noise than without: 1.4 times
/// the scatter counts, and studentFactor() times all. Where noise explains all of a figure by square it is 0 without noise, with the error that leaves.
/// docs/decisions/parameter-errors.md has the shares of simulated scans in which it covers.
///
/// A figure that is NaN, or in more than a quarter of the trials, has no effect, and of kPlaces one that noise changes by a fifth of it and more. Time: 2 pairs times that of
/// measuring, and twice for the louder trials; noise that the model does not see (in filtered scans what neighbours share along both directions) is left
/// out. Bit-identical for any number of threads if `measure` is. Errors: those of `measure` and withNoise.
[[nodiscard]] Result<std::vector<NoiseEffect>> noiseEffects(const Version& field, const NoiseModel& noise,
                                                            std::span<const double> found,
                                                            std::span<const NoiseGrowth> growth,
                                                            const FiguresOf& measure,
                                                            const NoiseTrialOptions& options,
                                                            JobControl& job);

/// What the trials say of one figure: `found`, and each pair's two values. As noiseEffects.
struct TrialPair {
  double more = 0.0, less = 0.0;
};
/// And what is known beside them.
struct TrialKnowledge {
  double doubt = 0.0;  ///< NoiseModel::doubt
  /// Values with the first pair's noise of twice the variance; NaN: not known.
  TrialPair louder{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
};
[[nodiscard]] NoiseEffect noiseEffectOf(double found, std::span<const TrialPair> pairs, NoiseGrowth growth,
                                        const TrialKnowledge& known = {});

/// The values that a figure can have.
struct FigureRange {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
};
/// An effect within it: without a value, and with the reason, where the error says nothing of the figure, since it is more than half of the range,
/// or, of a range with one end, than the figure's distance from that end with noise and without. A figure without noise that is beyond the
/// range is the end of it where it is no more than two errors away, else it has no value.
[[nodiscard]] NoiseEffect withinRange(const NoiseEffect& effect, double found, const FigureRange& range);

/// Adds to the error of kRank and kShare figures without a bend what extrapolation leaves of them on surfaces with steps, twice the square of `share` of each:
/// the noise's standard deviation over the surface's.
void addRankDoubt(std::span<NoiseEffect> effects, std::span<const NoiseGrowth> growth, double share);

}  // namespace fettle::engine
