#pragma once

#include <cstdint>
#include <optional>

#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"

namespace fettle::engine {

/// How many samples FilterKind::kOutliers of this spec cannot judge, whatever their height: of their window neither two samples
/// lie opposite each other across them, nor three that are not on one line are there. They stand between holes and at ragged rims,
/// where spikes are frequent; all keep their height. Of those that the spec's scope filters; edge lines, which narrow windows,
/// do not count. Cost: a look at each tile, and at the samples of tiles with holes; one thread, deterministic. Nothing: cancelled.
/// Thread: any.
[[nodiscard]] std::optional<std::int64_t> countUnjudged(const Version& field, const FilterSpec& spec,
                                                        const JobControl& job);

}  // namespace fettle::engine
