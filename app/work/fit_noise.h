#pragma once

#include "app/report.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/fit.h"

namespace fettle::app {

/// Sets the noise that the errors of fits to this field are by: of samples by engine::estimateNoise, or by engine::measureNoise
/// where samples of a line share some of it, how much of it they share, and what whole rows and columns are off. One for the
/// command line and the window. Errors: kCancelled. Thread: any; a long job.
[[nodiscard]] engine::Status setNoise(engine::FitOptions& how, const engine::Version& field,
                                      engine::JobControl& job);

}  // namespace fettle::app
