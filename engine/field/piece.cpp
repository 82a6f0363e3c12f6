#include "engine/field/piece.h"

#include <algorithm>
#include <cstddef>
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

}  // namespace fettle::engine
