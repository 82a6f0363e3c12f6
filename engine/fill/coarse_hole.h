#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/fill/fill.h"
#include "engine/fill/holes.h"

namespace fettle::engine {

/// About what a hole is filled with.
struct CoarseHole {
  std::vector<float> heights;  ///< in the order of its runs; NaN where nothing is known
  /// How far these are off those from means of four times as many samples: sum of squares [height_unit^2], over so many samples.
  double squares = 0.0;
  std::int64_t compared = 0;
};

/// From means around the hole that are filled by the same method: some thousand in the hole, some ten thousand in the rectangle around
/// it, whatever their sizes. Edge lines are no walls. Errors: kCancelled; those of fillHoles. Throws std::bad_alloc. Thread: any; a job of some hundredths
/// of a second on all workers of the arena.
[[nodiscard]] Result<CoarseHole> coarseHole(const Version& field, const FillOptions& options,
                                            const Holes& holes, const Hole& hole, JobControl& job);

}  // namespace fettle::engine
