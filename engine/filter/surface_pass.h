#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "engine/base/error.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"
#include "engine/filter/pass.h"

namespace fettle::engine {

/// Writes the results of a rectangle of samples, row-major, signs applied; unspecified at holes; up to 15 elements after each
/// row may be written. False when cancelled. Called from any thread, for several rectangles at once. Throws std::bad_alloc.
using SurfaceOf = std::function<bool(const SampleRect& rect, float* out, std::ptrdiff_t stride)>;

/// A FilterPass whose results are those of a surface, block by block: marks, holes, largest change and kept work as for
/// every filter. `reach`: no result depends on samples farther away [samples].
[[nodiscard]] Result<PassResult> passOfSurface(const SurfaceOf& surface, std::int32_t reach,
                                               const Version& input, const Version& original,
                                               const FilterSpec& spec, const FilterTuning& tuning,
                                               JobControl& job);

}  // namespace fettle::engine
