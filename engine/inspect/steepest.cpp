#include "engine/inspect/steepest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/compare/tile_sums.h"

namespace fettle::engine {

namespace {

struct Best {
  double squared = -1.0;
  std::int32_t column = 0, row = 0;

  [[nodiscard]] bool worseThan(const Best& other) const noexcept {
    if (squared != other.squared) return squared < other.squared;
    return row != other.row ? row > other.row : column > other.column;
  }
};

}  // namespace

Result<SteepestCell> findSteepest(const Version& field, JobControl& job) {
  const FieldReader reader = field.reader();
  const Grid& grid = field.grid();
  const double by_x = grid.height_unit.mm / grid.spacingXMm();
  const double by_y = grid.height_unit.mm / grid.spacingYMm();
  job.begin("finding the steepest cell", tileCount(reader));
  const std::vector<Best> parts = forEachTile<Best>(reader, job, [&](const SampleRect& rect, Best& best) {
    constexpr int kSide = kTileSide + 1;
    float z[kSide * kSide];  // outside the field: NaN, so that no cell reaches over the border
    reader.readHeights(rect.column, rect.row, rect.columns + 1, rect.rows + 1, z, kSide);
    for (int r = 0; r < rect.rows; ++r)
      for (int c = 0; c < rect.columns; ++c) {
        const double a = z[r * kSide + c], b = z[r * kSide + c + 1];
        const double d = z[(r + 1) * kSide + c], e = z[(r + 1) * kSide + c + 1];
        if (std::isnan(a + b + d + e)) continue;
        const double x = std::max(std::abs(b - a), std::abs(e - d)) * by_x;
        const double y = std::max(std::abs(d - a), std::abs(e - b)) * by_y;
        const Best here{x * x + y * y, rect.column + c, rect.row + r};
        if (best.worseThan(here)) best = here;
      }
  });
  if (job.cancelled()) return cancelled();
  Best best;
  for (const Best& part : parts)
    if (part.squared >= 0.0 && best.worseThan(part)) best = part;
  if (best.squared < 0.0) return SteepestCell{std::numeric_limits<double>::quiet_NaN(), 0, 0};
  return SteepestCell{std::sqrt(best.squared), best.column, best.row};
}

}  // namespace fettle::engine
