#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/measure/align_level.h"
#include "engine/measure/align_spread.h"
#include "engine/measure/height_map.h"

namespace fettle::engine {

/// Shifts [mm] that may bring a map onto itself, as the period of grooves or of a grid: local maxima of the autocorrelation of what it has without
/// long waves, of those nearly as great as the greatest the shortest, four at most, each for both directions. Periods from about four places of at
/// most 2^18 to half of the map. Errors: kCancelled. Throws std::bad_alloc. Thread: any; on all workers of the calling arena.
[[nodiscard]] Result<std::vector<glm::dvec2>> likelyRepeats(const HeightMap& map, JobControl& job);

/// Whether what another motion leaves under the points is no more than what the best one leaves there: not in the sum, by how the
/// sums over 12 x 12 blocks of the points scatter, at four standard errors, and not in one block alone either, which is where something lies that occurs once.
/// Of points that have a height under both; false where these are fewer than half of those of the best. `spread`: of the best one's residuals.
/// Throws std::bad_alloc.
[[nodiscard]] bool fitsAsWell(const AlignLevel& level, const std::vector<AlignLevel::Under>& best,
                              const std::vector<AlignLevel::Under>& other, const AlignSpread& spread);

}  // namespace fettle::engine
