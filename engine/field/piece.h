#pragma once

#include <cstdint>
#include <vector>

#include "engine/field/edge_line.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// The samples [column, column + columns) x [row, row + rows) of a field, with their marks, as a separate
/// field with its own memory, with the sign applied to the heights. The rectangle lies in the field. Throws
/// std::bad_alloc.
[[nodiscard]] Version pieceOf(const Version& field, std::int32_t column, std::int32_t row,
                              std::int32_t columns, std::int32_t rows);

/// Rows [first, first + count) of a field as pieceOf() has them, at their place: the origin is that of the first one. Throws
/// std::bad_alloc.
[[nodiscard]] Version rowsOf(const Version& field, std::int32_t first, std::int32_t count);

/// `columns` x `rows` samples spread evenly over a field, with their marks and without its edge lines: its whole shape, coarsely. At least 1 and
/// at most as many as the field has, in each direction. Throws std::bad_alloc.
[[nodiscard]] Version spreadOver(const Version& field, std::int32_t columns, std::int32_t rows);

/// Edge lines in the coordinates of a piece of their field: their points in and near it, and for each run of these a line.
/// Throws std::bad_alloc.
[[nodiscard]] EdgeLines linesOfPiece(const std::vector<EdgeLine>& lines, const SampleRect& piece);

}  // namespace fettle::engine
