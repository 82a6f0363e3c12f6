#pragma once

#include "engine/base/job.h"
#include "engine/filter/erosion.h"
#include "engine/simd/cpu.h"

namespace fettle::engine {

/// As erode() of erosion.h for an element that has chords.
[[nodiscard]] bool erodeDisk(const FlatElement& element, const Patch<float>& from, Patch<float>& to,
                             bool parallel, CpuLevel level, const JobControl& job);

}  // namespace fettle::engine
