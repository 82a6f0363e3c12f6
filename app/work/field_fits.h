#pragma once

#include <string>
#include <vector>

#include "app/report.h"
#include "app/work/fit_files.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/fit_choice.h"
#include "engine/measure/fit_regions.h"

namespace fettle::app {

/// Shapes fitted to regions of a field.
struct FieldFits {
  std::vector<FittedRegion> fitted;
  Report report;                      ///< of `fettle fit`, without what lies between two of them
  std::vector<std::string> warnings;  ///< of fits that are none
};

/// Fits the best of `kinds` to each region, numbered from 1, as `fettle fit` does. Of several regions those that determine no shape are
/// listed as `not_fitted`. Errors: as engine::fitBestShape.
[[nodiscard]] engine::Result<FieldFits> fitEach(const engine::Version& field,
                                                std::vector<engine::FitRegion> regions,
                                                const std::vector<engine::ShapeKind>& kinds,
                                                const engine::FitOptions& how, engine::JobControl& job);

/// Adds what lies between two fits of it, by the numbers of their regions, to a report. Errors (kInput): one that has no fit, naming
/// --between.
[[nodiscard]] engine::Status addRelation(FieldFits& fits, int first, int second);

/// The shapes of all fits, bounded as their samples are, as a STEP file.
[[nodiscard]] std::string fitStep(const engine::Version& field, const std::vector<FittedRegion>& fitted);

}  // namespace fettle::app
