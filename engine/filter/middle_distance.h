#pragma once

#include <cstddef>

#include "engine/field/reader.h"

namespace fettle::engine {

/// The median of |z - surface| over a field's samples, for an even count the mean of the two middle ones; each distance
/// rounded to float. 0 for a field of holes. surface: row-major, stride in elements, no NaN at a sample.
/// Exact, for any number of threads. Three passes over the field, 0.5 MB a thread. Throws std::bad_alloc. Thread: any, on all
/// workers of the calling arena.
[[nodiscard]] double middleDistance(const FieldReader& field, const float* surface, std::ptrdiff_t stride);

}  // namespace fettle::engine
