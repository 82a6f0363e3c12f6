#pragma once

#include <cstdint>
#include <functional>

#include <glm/vec2.hpp>

#include "engine/field/grid.h"
#include "engine/field/sample_rect.h"
#include "engine/marks/change_marks.h"

namespace fettle::engine {

/// The samples between two corners in field coordinates [mm], in any order, as far as they are in the field; empty where
/// none is. A sample on a side belongs to it, also where it is 1e-6 of a spacing beyond by rounding. Corners are finite.
[[nodiscard]] SampleRect samplesBetween(const Grid& grid, const glm::dvec2& corner_mm,
                                        const glm::dvec2& other_mm) noexcept;

/// Its samples in a tile.
[[nodiscard]] MarkRows rowsInside(const SampleRect& rect, std::int32_t tile_column,
                                  std::int32_t tile_row) noexcept;

/// The field with these samples marked, but for holes, and no others. `inside`: the samples of a tile, from several threads at
/// a time. Errors as changeMarks.
[[nodiscard]] Result<Version> onlyMarked(const Version& field,
                                         const std::function<MarkRows(std::int32_t, std::int32_t)>& inside,
                                         JobControl& job);

/// The marks of `other`, a field of the same sides, but for holes, and no others.
[[nodiscard]] Result<Version> withMarksFrom(const Version& field, const Version& other, JobControl& job);

}  // namespace fettle::engine
