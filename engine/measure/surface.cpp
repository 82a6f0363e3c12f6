#include "engine/measure/surface.h"

#include <algorithm>
#include <cmath>

#include "engine/compare/tile_sums.h"

namespace fettle::engine {

namespace {

// Of a region's samples in a tile.
struct ExtentPart {
  std::int32_t left = Grid::kMaxSide, right = -1, low = Grid::kMaxSide, high = -1;
  std::int64_t samples = 0;
};

}  // namespace

Result<Surface> surfaceOf(const Version& field, const NominalForm& form, double mean, Region region,
                          JobControl& job) {
  const FieldReader reader = field.reader();
  const Grid& grid = reader.grid();
  job.begin("reading heights", 2 * tileCount(reader));
  const auto parts = forEachTile<ExtentPart>(reader, job, [&](const SampleRect& rect, ExtentPart& part) {
    float z[kTileSide * kTileSide];
    readRegion(reader, region, rect, z, kTileSide);
    for (int r = 0; r < rect.rows; ++r)
      for (int c = 0; c < rect.columns; ++c) {
        if (std::isnan(z[r * kTileSide + c])) continue;
        ++part.samples;
        part.left = std::min(part.left, rect.column + c);
        part.right = std::max(part.right, rect.column + c);
        part.low = std::min(part.low, rect.row + r);
        part.high = std::max(part.high, rect.row + r);
      }
  });
  if (job.cancelled()) return cancelled();
  ExtentPart all;
  for (const ExtentPart& part : parts) {
    all.samples += part.samples;
    all.left = std::min(all.left, part.left);
    all.right = std::max(all.right, part.right);
    all.low = std::min(all.low, part.low);
    all.high = std::max(all.high, part.high);
  }
  Surface surface;
  surface.spacing_x = grid.spacingXMm();
  surface.spacing_y = grid.spacingYMm();
  surface.height_mm = grid.height_unit.mm;
  surface.samples = all.samples;
  if (all.samples == 0) return surface;
  surface.first_column = all.left;
  surface.first_row = all.low;
  surface.width = all.right - all.left + 1;
  surface.height = all.high - all.low + 1;
  const auto width = static_cast<std::size_t>(surface.width);
  surface.heights.assign(width * static_cast<std::size_t>(surface.height), 0.0F);
  struct Nothing {};
  (void)forEachTile<Nothing>(reader, job, [&](const SampleRect& rect, Nothing&) {
    float z[kTileSide * kTileSide];
    double nominal[kTileSide * kTileSide];
    readRegion(reader, region, rect, z, kTileSide);
    form.readHeights(rect, nominal, kTileSide);
    const int left = std::max(all.left - rect.column, 0),
              right = std::min(all.right - rect.column + 1, rect.columns);
    const int low = std::max(all.low - rect.row, 0), high = std::min(all.high - rect.row + 1, rect.rows);
    for (int r = low; r < high; ++r) {
      float* const out = surface.heights.data() + static_cast<std::size_t>(rect.row + r - all.low) * width +
                         (rect.column - all.left);
      for (int c = left; c < right; ++c)
        out[c] = static_cast<float>(z[r * kTileSide + c] - nominal[r * kTileSide + c] - mean);
    }
  });
  if (job.cancelled()) return cancelled();
  return surface;
}

}  // namespace fettle::engine
