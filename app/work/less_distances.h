#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::app {

/// The heights of `field` less those of `distances`, of the same size: what a field is distances away from. Holes where either has one.
/// Signs applied, no marks. Errors: kFailed without memory; kCancelled. Thread: any.
[[nodiscard]] engine::Result<engine::Version> lessDistances(const engine::Version& field,
                                                            const engine::Version& distances,
                                                            engine::JobControl& job);

}  // namespace fettle::app
