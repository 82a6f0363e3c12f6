#include "engine/filter/unjudged.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/field/reader.h"

namespace fettle::engine {

namespace {

// The samples of a tile and, `radius` wide, around it; beyond the field there are holes.
class Surroundings {
 public:
  explicit Surroundings(int radius) : radius_(radius) {}

  void read(const FieldReader& reader, std::int32_t column, std::int32_t row, std::int32_t columns,
            std::int32_t rows) {
    stride_ = columns + 2 * radius_;
    heights_.resize(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(rows + 2 * radius_));
    reader.readHeights(column - radius_, row - radius_, stride_, rows + 2 * radius_, heights_.data(),
                       stride_);
  }
  [[nodiscard]] bool has(std::int32_t column, std::int32_t row) const noexcept {
    return !std::isnan(heights_[static_cast<std::size_t>(row + radius_) * static_cast<std::size_t>(stride_) +
                                static_cast<std::size_t>(column + radius_)]);
  }
  // Two opposite each other, or three that are not on one line.
  [[nodiscard]] bool judge(std::int32_t column, std::int32_t row) const noexcept {
    if (has(column - 1, row) && has(column + 1, row)) return true;  // nearly all
    std::int32_t first_x = 0, first_y = 0, way_x = 0, way_y = 0;
    int found = 0;
    for (std::int32_t dy = -radius_; dy <= radius_; ++dy)
      for (std::int32_t dx = -radius_; dx <= radius_; ++dx) {
        if ((dx == 0 && dy == 0) || !has(column + dx, row + dy)) continue;
        if (has(column - dx, row - dy)) return true;
        if (++found == 1) {
          first_x = dx, first_y = dy;
        } else if (found == 2) {
          way_x = dx - first_x, way_y = dy - first_y;
        } else if (way_x * (dy - first_y) != way_y * (dx - first_x)) {
          return true;
        }
      }
    return false;
  }

 private:
  std::int32_t radius_, stride_ = 0;
  std::vector<float> heights_;
};

}  // namespace

std::optional<std::int64_t> countUnjudged(const Version& field, const FilterSpec& spec,
                                          const JobControl& job) {
  const FieldReader reader = field.reader();
  // A single row or column has no two dimensions: what its windows hold are the samples along it, as they are.
  const std::int32_t radius = spec.window / 2;
  Surroundings around(radius);
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(kTileSide) * kTileSide);
  std::int64_t unjudged = 0;
  for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < reader.tileColumns(); ++tc) {
      if (job.cancelled()) return std::nullopt;
      const std::int32_t column = tc * kTileSide, row = tr * kTileSide,
                         columns = std::min(kTileSide, reader.width() - column),
                         rows = std::min(kTileSide, reader.height() - row);
      // In a whole tile of two rows and columns and more each sample has three that are not on one line.
      if (!reader.entry(tc, tr).holed && columns > 1 && rows > 1) continue;
      around.read(reader, column, row, columns, rows);
      reader.readMarks(column, row, columns, rows, marks.data(), columns);
      for (std::int32_t r = 0; r < rows; ++r)
        for (std::int32_t c = 0; c < columns; ++c) {
          const bool marked = marks[static_cast<std::size_t>(r * columns + c)] != 0;
          const bool counts = spec.scope == FilterScope::kKeepMarks ? !marked : marked;
          if (counts && around.has(c, r) && !around.judge(c, r)) ++unjudged;
        }
    }
  return unjudged;
}

}  // namespace fettle::engine
