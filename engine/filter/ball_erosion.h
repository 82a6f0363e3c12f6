#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/job.h"
#include "engine/filter/ball_element.h"
#include "engine/filter/patch.h"
#include "engine/simd/cpu.h"

namespace fettle::engine {

/// Samples in groups, for the bounds of what they come to: all that an erosion by a ball takes beside its patches.
struct BallScratch {
  std::vector<float> blocked, small_least, large_least, large_x, large_y;
};

/// The least of `from` plus the depth of a ball around each sample of to.rect, where `from` has one; else -infinity. Samples that
/// `from` has not are +infinity; from.rect holds all samples of the field that the ball reaches. Each sum is rounded once, so that
/// the least of them is the same for any rectangle and level. `parallel`: on all workers of the arena. False when cancelled: then
/// `to` means nothing. Throws std::bad_alloc.
[[nodiscard]] bool erode(const BallElement& element, const Patch<float>& from, Patch<double>& to,
                         bool parallel, CpuLevel level, BallScratch& scratch, const JobControl& job);
[[nodiscard]] bool erode(const BallElement& element, const Patch<double>& from, Patch<double>& to,
                         bool parallel, CpuLevel level, BallScratch& scratch, const JobControl& job);

}  // namespace fettle::engine
