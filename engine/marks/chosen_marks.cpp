#include "engine/marks/chosen_marks.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fettle::engine {

namespace {

// The first sample of a row or column from `from` to `to`, and how many.
std::pair<std::int32_t, std::int32_t> samplesOfSide(double from, double to, double spacing,
                                                    std::int32_t count) noexcept {
  constexpr double kRounding = 1e-6;
  const double first = std::max(0.0, std::ceil(std::min(from, to) / spacing - kRounding));
  const double last = std::min(count - 1.0, std::floor(std::max(from, to) / spacing + kRounding));
  if (!(first <= last)) return {0, 0};
  return {static_cast<std::int32_t>(first), static_cast<std::int32_t>(last - first) + 1};
}

}  // namespace

SampleRect samplesBetween(const Grid& grid, const glm::dvec2& corner_mm,
                          const glm::dvec2& other_mm) noexcept {
  const auto [column, columns] = samplesOfSide(corner_mm.x, other_mm.x, grid.spacingXMm(), grid.width);
  const auto [row, rows] = samplesOfSide(corner_mm.y, other_mm.y, grid.spacingYMm(), grid.height);
  return columns == 0 || rows == 0 ? SampleRect{} : SampleRect{column, row, columns, rows};
}

MarkRows rowsInside(const SampleRect& rect, std::int32_t tile_column, std::int32_t tile_row) noexcept {
  MarkRows rows{};
  const std::int64_t c0 = std::max<std::int64_t>(0, rect.column - std::int64_t{tile_column} * kTileSide),
                     c1 = std::min<std::int64_t>(kTileSide, rect.column + std::int64_t{rect.columns} -
                                                                std::int64_t{tile_column} * kTileSide);
  const std::int64_t r0 = std::max<std::int64_t>(0, rect.row - std::int64_t{tile_row} * kTileSide),
                     r1 = std::min<std::int64_t>(
                         kTileSide, rect.row + std::int64_t{rect.rows} - std::int64_t{tile_row} * kTileSide);
  if (c0 >= c1) return rows;
  const std::uint64_t below = c1 == kTileSide ? ~std::uint64_t{0} : (std::uint64_t{1} << c1) - 1;
  const std::uint64_t bits = below & (~std::uint64_t{0} << c0);
  for (std::int64_t r = r0; r < r1; ++r) rows[static_cast<std::size_t>(r)] = bits;
  return rows;
}

Result<Version> onlyMarked(const Version& field,
                           const std::function<MarkRows(std::int32_t, std::int32_t)>& inside,
                           JobControl& job) {
  return changeMarks(
      field, allTiles(field.grid()),
      [&](std::int32_t tc, std::int32_t tr, const Tile& tile, MarkRows& rows) {
        rows.fill(0);
        applyChange(tile, inside(tc, tr), MarkChange::kMark, rows);
      },
      job);
}

Result<Version> withMarksFrom(const Version& field, const Version& other, JobControl& job) {
  const FieldReader from = other.reader();
  return changeMarks(
      field, allTiles(field.grid()),
      [&](std::int32_t tc, std::int32_t tr, const Tile& tile, MarkRows& rows) {
        rows.fill(0);
        applyChange(tile, from.tile(tc, tr).marks, MarkChange::kMark, rows);
      },
      job);
}

}  // namespace fettle::engine
