#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/form_fit.h"

namespace fettle::app {

/// Of a plane through three points of this field: adds to its errors what whole rows and columns are off (engine::addLineErrors), by
/// sectionNoiseOf(). Another form stays as it is, at no cost. Errors: kCancelled. Thread: any; a long job.
[[nodiscard]] engine::Status addThroughNoise(engine::FittedForm& fit, const engine::Version& field,
                                             const engine::FormChoice& choice, engine::JobControl& job);

}  // namespace fettle::app
