#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/rigid_motion.h"

namespace fettle::engine {

/// The second field, moved, at the samples of a grid: the height of its bilinear patches there, rounded to float once, in
/// the grid's height unit. A hole where the patch has one, outside, and where the moved surface overhangs. No marks.
/// Errors: kFailed without memory; kCancelled. Thread: any; a long job on all workers of the
/// calling arena.
[[nodiscard]] Result<Version> movedOnto(const Version& second, const RigidMotion& motion, const Grid& grid,
                                        JobControl& job);

}  // namespace fettle::engine
