#pragma once

#include <cstdint>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// The cell that rises most.
struct SteepestCell {
  double slope = 0.0;  ///< length of the gradient, height over distance, both in mm; NaN without a cell
  std::int32_t column = 0, row = 0;  ///< its lower-left sample, row 0 lowest; 0 .. width - 2, height - 2
};

/// Tests every cell without a hole. The gradient of a bilinear patch is longest in one of its corners (each
/// component is linear in one coordinate and constant in the other, so the square is convex): slope is exact
/// apart from rounding in double. Of equally steep cells the one of the lowest row, then column, is returned.
/// The same for any number of threads. Errors: kCancelled. Thread: any, on all workers of the calling arena.
[[nodiscard]] Result<SteepestCell> findSteepest(const Version& field, JobControl& job);

}  // namespace fettle::engine
