#include "engine/field/piece.h"

#include <cstddef>
#include <vector>

#include "engine/field/builder.h"

namespace fettle::engine {

Version pieceOf(const Version& field, std::int32_t column, std::int32_t row, std::int32_t columns,
                std::int32_t rows) {
  const std::size_t samples = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  std::vector<float> heights(samples);
  std::vector<std::uint8_t> marks(samples);
  field.reader().readHeights(column, row, columns, rows, heights.data(), columns);
  field.reader().readMarks(column, row, columns, rows, marks.data(), columns);
  Grid grid = field.grid();
  grid.width = columns;
  grid.height = rows;
  return makeField(grid, heights, marks);
}

}  // namespace fettle::engine
