#pragma once

#include <functional>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// Writes the heights that are taken from the samples of a rectangle within a tile, row-major with stride kTileSide
/// [height_unit]. Called from any thread, for several rectangles at once.
using HeightsOf = std::function<void(const SampleRect& rect, double* out)>;

/// The field with every sample lowered by a height: z - h, signs applied, rounded to float once. Holes, marks, edge lines
/// and the field's place stay. `stage` (a literal) names the job. Errors: kFailed without memory; kCancelled. Thread: any; a
/// long job on all workers of the calling arena.
[[nodiscard]] Result<Version> lowered(const Version& field, const char* stage, const HeightsOf& heights,
                                      JobControl& job);

}  // namespace fettle::engine
