#pragma once

#include <vector>

#include "engine/base/job.h"
#include "engine/measure/height_map.h"
#include "engine/measure/rigid_motion.h"

namespace fettle::engine {

/// Clips a map, whose heights are about 0, at three normalised median sizes, so that spikes and walls do not decide. Throws std::bad_alloc.
void clipSpikes(HeightMap& map);

/// Starts for an alignment: the places at which the maps' correlation is greatest, over all shifts that leave `least_share`
/// of the smaller map in common and rotations about z up to `most_rotation_deg`, the likeliest first; without rotations
/// that is one angle, without shifts none. Turns and shifts about `centre`, heights left as they are. Stops early when the
/// job is cancelled. Throws std::bad_alloc. Thread: any; on all workers of the calling arena.
[[nodiscard]] std::vector<RigidMotion> likelyMotions(const HeightMap& first, const HeightMap& second,
                                                     double most_rotation_deg, const glm::dvec3& centre,
                                                     JobControl& job);

}  // namespace fettle::engine
