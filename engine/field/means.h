#pragma once

#include <cstdint>

#include "engine/field/sample_rect.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// Means of `step` x `step` samples of a rectangle of a field as a field of their own, with its sign, `step` times its spacing
/// and memory of its own, without edge lines and form: what a picture shows that resolves no more. Of a cell four rows at most
/// count, about evenly spread. Holes do not count; a cell of holes is one. A cell is marked when half of its samples are. The
/// rectangle lies in the field. All workers of the calling arena; throws std::bad_alloc.
[[nodiscard]] Version meansOf(const Version& field, const SampleRect& rect, std::int32_t step);

/// Of a cell one row in so many counts, from its first.
[[nodiscard]] std::int32_t rowsApartInMean(std::int32_t step) noexcept;

/// Samples that a mean is of.
[[nodiscard]] std::int32_t samplesOfMean(std::int32_t step) noexcept;

}  // namespace fettle::engine
