#pragma once

#include <string>

#include "app/report.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/filter/catalogue.h"

namespace fettle::app {

/// Of a robust filter, the samples that had no weight: `weightless` of a report, and a warning where they are many. `of`: the
/// scan, and the step where there are several.
void addWeightless(Report& report, const engine::Filter& filter, const engine::FilterReport& done,
                   const std::string& of);

/// A warning where a filter's cut-off is longer than the field.
/// Of FilterKind::kOutliers, the samples that it could not judge: `unjudged` of a report, and a warning where there are any. Errors:
/// kCancelled.
[[nodiscard]] engine::Status addUnjudged(Report& report, const engine::Version& field,
                                         const engine::FilterSpec& spec, const std::string& of,
                                         const engine::JobControl& job);
void warnOfCutoff(const engine::FilterSpec& spec, const engine::Grid& grid, const std::string& of);

/// A warning where a limit of the change from the scan as it was opened brought back what earlier steps had moved farther.
void warnOfBroughtBack(const engine::FilterSpec& spec, const engine::FilterReport& done,
                       const engine::Grid& grid, const std::string& of);

}  // namespace fettle::app
