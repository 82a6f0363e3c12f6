#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/field/tile.h"

// The two passes over every sample of a field that is built. Threading: any; calls touch what they are given.

namespace fettle::engine {

/// Copies columns x rows heights (row-major, strides in elements) to `to`, stride kTileSide. What is not finite
/// becomes a hole. Returns how many were infinite.
[[nodiscard]] std::int32_t copyHeights(const float* from, std::ptrdiff_t stride, float* to,
                                       std::int32_t columns, std::int32_t rows) noexcept;

/// Computes all that a tile stores of its samples and marks: the bounds of blocks and tile as refreshBounds of the
/// whole tile, counts of NaN and marks.
void summariseTile(Tile& tile) noexcept;

}  // namespace fettle::engine
