#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"
#include "engine/inspect/noise.h"

namespace fettle::engine {

/// The spec with a range sigma: its own when it has one or needs none, else Filter::noises times the noise that
/// estimateNoise finds in `field`. A spec to be applied in parts or again later is given its range first: a
/// part has a noise of its own. Errors: no noise to be seen in the field (kInput), cancelled. As
/// estimateNoise otherwise.
[[nodiscard]] Result<FilterSpec> withMeasuredRange(const FilterSpec& spec, const Version& field,
                                                   JobControl& job);

/// The same from noise that was estimated before; `spec` needs a range and has none. Errors: as above.
[[nodiscard]] Result<FilterSpec> withRangeOf(const FilterSpec& spec, const NoiseEstimate& noise);

}  // namespace fettle::engine
