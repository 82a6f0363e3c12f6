#pragma once

#include <string>
#include <vector>

#include "app/report.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/fit_choice.h"
#include "engine/measure/fit_relation.h"

namespace fettle::app {

/// A region with what was fitted to it.
struct FittedRegion {
  int number = 0;  ///< from 1
  engine::FitRegion region;
  engine::ChosenShape chosen;
};

/// The fit as keys of a report.
[[nodiscard]] Report fitReport(const FittedRegion& fitted);
/// What lies between two fits as keys of a report.
[[nodiscard]] Report relationReport(int first, int second, const engine::ShapeRelation& relation);

/// "region 1: hollow cylinder, 1234 samples, rms 0.31 um" of a fitReport().
[[nodiscard]] std::string fitTitle(const Report& fit);
/// A figure as text, to two digits of its standard error.
struct FitLine {
  std::string name, text;  ///< "radius", "5.02 +- 0.01 mm"
};
[[nodiscard]] std::vector<FitLine> fitLines(const Report& fit);
/// Of the figure of a fitReport() that noise moves most on average in parts of its standard error, where that is more than a third of it: a warning;
/// else empty.
[[nodiscard]] std::string biasWarning(const Report& fit, bool vertical);
/// The noise that standard errors are by, of the report of fits or of form (`noise_mm`, `noise_rows_mm`, `noise_columns_mm`): "noise
/// between samples 0.31 um, of whole rows 2 um"; empty where it is not known.
[[nodiscard]] std::string errorNoiseText(const Report& report);

/// The same lines of a relationReport(), those that there are.
[[nodiscard]] std::vector<FitLine> relationLines(const Report& between);

/// A row for each figure: region, shape, figure, value, standard error, unit. Of the report.
[[nodiscard]] std::string fitCsv(const Report& report);

/// The distances of the samples of all fits from their shapes, in the field's height unit, as its samples; holes elsewhere.
/// Errors: kFailed without memory; kCancelled.
[[nodiscard]] engine::Result<engine::Version> residualField(const engine::Version& field,
                                                            const std::vector<FittedRegion>& fitted,
                                                            bool vertical, engine::JobControl& job);

}  // namespace fettle::app
