#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/region.h"

namespace fettle::engine {

/// `field` with holes where the sample of `by`, a field of the same sides, is not in the region. Shares all tiles that lose
/// none. Errors: kCancelled, kFailed without memory. Thread: any.
[[nodiscard]] Result<Version> onlyRegion(const Version& field, const Version& by, Region region,
                                         JobControl& job);

}  // namespace fettle::engine
