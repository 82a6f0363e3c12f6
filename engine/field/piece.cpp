#include "engine/field/piece.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "engine/field/builder.h"

namespace fettle::engine {

EdgeLines linesOfPiece(const std::vector<EdgeLine>& lines, const SampleRect& piece) {
  constexpr double kNear = 2.0 * EdgeLine::kMostApart;
  const glm::dvec2 first{piece.column, piece.row};
  const auto isNear = [&](const EdgePoint& point) {
    const glm::dvec2 p = point.position - first;
    return p.x >= -kNear && p.y >= -kNear && p.x < piece.columns + kNear && p.y < piece.rows + kNear;
  };
  auto kept = std::make_shared<std::vector<EdgeLine>>();
  for (const EdgeLine& line : lines) {
    const std::size_t n = line.points.size();
    const bool whole = std::ranges::all_of(line.points, isNear);
    EdgeLine run{line.id, line.closed && whole, {}};
    for (std::size_t i = 0; i < n + (line.closed && !whole ? 1 : 0); ++i) {
      EdgePoint point = line.points[i % n];
      if (isNear(point)) {
        point.position -= first;
        run.points.push_back(point);
      } else if (!run.points.empty()) {
        kept->push_back(std::exchange(run, EdgeLine{line.id, false, {}}));
      }
    }
    if (!run.points.empty()) kept->push_back(std::move(run));
  }
  return kept;
}

namespace {

Version cutOut(const Version& field, const SampleRect& rect, double origin_x, double origin_y) {
  const auto [column, row, columns, rows] = rect;
  const std::size_t samples = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  std::vector<float> heights(samples);
  std::vector<std::uint8_t> marks(samples);
  field.reader().readHeights(column, row, columns, rows, heights.data(), columns);
  field.reader().readMarks(column, row, columns, rows, marks.data(), columns);
  Grid grid = field.grid();
  grid.width = columns;
  grid.height = rows;
  grid.origin_x = origin_x;
  grid.origin_y = origin_y;
  const Version piece = makeField(grid, heights, marks);
  return field.lines() == nullptr
             ? piece
             : piece.withLines(linesOfPiece(*field.lines(), {column, row, columns, rows}));
}

}  // namespace

Version pieceOf(const Version& field, std::int32_t column, std::int32_t row, std::int32_t columns,
                std::int32_t rows) {
  return cutOut(field, {column, row, columns, rows}, field.grid().origin_x, field.grid().origin_y);
}

Version rowsOf(const Version& field, std::int32_t first, std::int32_t count) {
  const Grid& grid = field.grid();
  return cutOut(field, {0, first, grid.width, count}, grid.origin_x, grid.origin_y + first * grid.spacing_y);
}

Version spreadOver(const Version& field, std::int32_t columns, std::int32_t rows) {
  Grid grid = field.grid();
  const auto [width, height] = std::pair{grid.width, grid.height};
  assert(columns >= 1 && columns <= width && rows >= 1 && rows <= height);
  grid.width = columns;
  grid.height = rows;
  grid.spacing_x *= static_cast<double>(width) / columns;
  grid.spacing_y *= static_cast<double>(height) / rows;
  std::vector<float> line(static_cast<std::size_t>(width)), heights;
  std::vector<std::uint8_t> marked(line.size()), marks;
  heights.reserve(static_cast<std::size_t>(grid.samples()));
  marks.reserve(heights.capacity());
  for (std::int64_t r = 0; r < rows; ++r) {
    const auto from = static_cast<std::int32_t>(r * height / rows);
    field.reader().readHeights(0, from, width, 1, line.data(), width);
    field.reader().readMarks(0, from, width, 1, marked.data(), width);
    for (std::int64_t c = 0; c < columns; ++c) {
      const auto at = static_cast<std::size_t>(c * width / columns);
      heights.push_back(line[at]);
      marks.push_back(marked[at]);
    }
  }
  return makeField(grid, heights, marks);
}

}  // namespace fettle::engine
