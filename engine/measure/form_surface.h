#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/nominal_form.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// The heights of a form as a field over `grid`, upright and without holes; where another form already lies over what is seen,
/// less that one: what is seen less this surface is what would be seen under `form`. Rounded to float once, so that difference
/// is off by half a unit in the last place of the surface: enough for a picture, while SeenField takes forms out in double.
/// Errors: kFailed without memory; kCancelled. Thread: any; a long job on all workers of the calling arena.
[[nodiscard]] Result<Version> formSurface(const Grid& grid, const NominalForm& form, const NominalForm* over,
                                          JobControl& job);

}  // namespace fettle::engine
