#pragma once

#include "app/report.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::app {

/// The places where an edge line drawn by hand would gain tgv most (findWorthPlaces), `most` at the most: "places", each
/// with its middle in the scan's own coordinates, length, gain, error left after it and seconds; "rmse_without", the
/// error that tgv leaves without them; "places_unit" and "places_lateral_unit". Errors: no noise in the scan (kInput),
/// and those of findWorthPlaces().
[[nodiscard]] engine::Result<Report> placeReport(const engine::Version& field, int most, int threads,
                                                 engine::JobControl& job);

/// For people.
void printPlaces(const Report& report);

}  // namespace fettle::app
