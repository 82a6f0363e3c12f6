#include "engine/field/means.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <tbb/parallel_for.h>

#include "engine/field/builder.h"

namespace fettle::engine {

namespace {

constexpr std::int32_t kRowsOfCell = 4;  // read of each cell: the others are a fetch from memory each

}  // namespace

std::int32_t rowsApartInMean(std::int32_t step) noexcept {
  return std::max(1, step / kRowsOfCell);
}

std::int32_t samplesOfMean(std::int32_t step) noexcept {
  return step * ((step + rowsApartInMean(step) - 1) / rowsApartInMean(step));
}

Version meansOf(const Version& field, const SampleRect& rect, std::int32_t step) {
  const Version upright = field.reader().sign() > 0.0F ? field : field.inverted();
  const FieldReader reader = upright.reader();
  const bool marked = reader.root().marked_children != 0;
  Grid grid = field.grid();
  grid.width = (rect.columns + step - 1) / step;
  grid.height = (rect.rows + step - 1) / step;
  grid.spacing_x *= step;
  grid.spacing_y *= step;
  const auto wide = static_cast<std::size_t>(grid.width);
  std::vector<float> heights(wide * static_cast<std::size_t>(grid.height));
  std::vector<std::uint8_t> marks(marked ? heights.size() : 0);
  tbb::parallel_for(std::int32_t{0}, grid.height, [&](std::int32_t y) {
    std::vector<float> row(static_cast<std::size_t>(rect.columns));
    std::vector<std::uint8_t> marks_of_row(marked ? row.size() : 0);
    std::vector<double> sums(wide);
    std::vector<std::int32_t> counts(wide), marks_in(marked ? wide : 0);
    const std::int32_t end = std::min((y + 1) * step, rect.rows);
    std::int32_t rows = 0;
    for (std::int32_t r = y * step; r < end; r += rowsApartInMean(step), ++rows) {
      reader.readHeights(rect.column, rect.row + r, rect.columns, 1, row.data(), rect.columns);
      for (std::size_t x = 0; x < wide; ++x) {
        const std::size_t c1 = std::min((x + 1) * static_cast<std::size_t>(step), row.size());
        double sum = 0.0;
        std::int32_t count = 0;
        for (std::size_t c = x * static_cast<std::size_t>(step); c < c1; ++c) {
          const bool there = row[c] == row[c];
          sum += there ? static_cast<double>(row[c]) : 0.0;
          count += there ? 1 : 0;
        }
        sums[x] += sum;
        counts[x] += count;
      }
      if (!marked) continue;
      reader.readMarks(rect.column, rect.row + r, rect.columns, 1, marks_of_row.data(), rect.columns);
      for (std::size_t c = 0; c < row.size(); ++c)
        marks_in[c / static_cast<std::size_t>(step)] += marks_of_row[c];
    }
    for (std::size_t x = 0; x < wide; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * wide + x;
      heights[at] = counts[x] > 0 ? static_cast<float>(sums[x] / counts[x]) : std::nanf("");
      if (marked) marks[at] = 2 * marks_in[x] >= step * rows ? 1 : 0;
    }
  });
  const Version means = makeField(grid, heights, marks);
  return field.reader().sign() > 0.0F ? means : means.inverted();
}

}  // namespace fettle::engine
