#pragma once

#include <cstdint>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/nominal_form.h"
#include "engine/field/version.h"

namespace fettle::bench {

/// A plane that is tilted by a tenth along both sides, and a sphere of ten times the field's diagonal, over a field.
[[nodiscard]] engine::NominalForm benchPlane(const engine::Grid& grid);
[[nodiscard]] engine::NominalForm benchSphere(const engine::Grid& grid);

/// A field as it is seen when it was bent by a form that is taken out again: its own heights but for the rounding of the bent
/// ones, held as every field under a form is held. Errors: kFailed without memory, kCancelled.
[[nodiscard]] engine::Result<engine::Version> bentAndSeen(const engine::Version& field,
                                                          const engine::NominalForm& form,
                                                          engine::JobControl& job);

/// Bytes of the tiles that a field that is seen does not share with its samples.
[[nodiscard]] std::int64_t bytesOfSeen(const engine::Version& seen);

}  // namespace fettle::bench
