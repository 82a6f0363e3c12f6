#pragma once

#include <optional>

#include "engine/base/job.h"
#include "engine/measure/fit_samples.h"
#include "engine/measure/fit_shape.h"
#include "engine/measure/fit_solve.h"

namespace fettle::engine {

/// The normalised median of the weighted distances from a surface, at least `least`: the scale of robust weights.
[[nodiscard]] double robustScale(const FitPoints& points, const FitWeights& weights,
                                 const FitSurface& surface, double least);

/// Solves a model again and again from its base, with the scale of robust weights of what the round before left,
/// until the scale rests. False where no finite surface was found or the job was cancelled.
[[nodiscard]] bool fitInRounds(const FitPoints& points, FitWeights weights, bool robust, double least,
                               FitModel& model, JobControl& job);

/// The best of the likely shapes of a kind (fit_start.h) after such rounds on coarse points of the samples, in parts of
/// `scale`; nothing where none is finite.
[[nodiscard]] std::optional<FitModel> startOfFit(const FitSamples& samples, double scale, ShapeKind kind,
                                                 const FitWeights& weights, bool robust, double least,
                                                 JobControl& job);

}  // namespace fettle::engine
