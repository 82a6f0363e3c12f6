#pragma once

#include "engine/base/job.h"
#include "engine/filter/ball_element.h"
#include "engine/filter/patch.h"
#include "engine/simd/cpu.h"

namespace fettle::engine {

/// So few samples within the ball that going over all of them takes less than finding out which matter.
[[nodiscard]] bool isNear(const BallElement& element) noexcept;

/// As erode() of ball_erosion.h, over all samples that lie equally far away at once.
[[nodiscard]] bool erodeNear(const BallElement& element, const Patch<float>& from, Patch<double>& to,
                             bool parallel, CpuLevel level, const JobControl& job);
[[nodiscard]] bool erodeNear(const BallElement& element, const Patch<double>& from, Patch<double>& to,
                             bool parallel, CpuLevel level, const JobControl& job);

}  // namespace fettle::engine
