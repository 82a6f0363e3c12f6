#include "engine/measure/form_surface.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include <tbb/parallel_for.h>

#include "engine/field/builder.h"
#include "engine/field/sample_rect.h"
#include "engine/field/tile.h"

namespace fettle::engine {

Result<Version> formSurface(const Grid& grid, const NominalForm& form, const NominalForm* over,
                            JobControl& job) {
  Grid place = grid;
  place.height_per_count = 0.0;
  auto builder = FieldBuilder::create(std::move(place), "the surface of the form");
  if (!builder) return tl::unexpected(builder.error());
  const std::int32_t tile_columns = (grid.width + kTileSide - 1) / kTileSide;
  const std::int32_t tile_rows = (grid.height + kTileSide - 1) / kTileSide;
  job.begin("drawing the form",
            static_cast<std::uint64_t>(tile_columns) * static_cast<std::uint64_t>(tile_rows));
  tbb::parallel_for(std::int32_t{0}, tile_columns * tile_rows, [&](std::int32_t i) {
    if (job.cancelled()) return;
    const std::int32_t column = i % tile_columns * kTileSide, row = i / tile_columns * kTileSide;
    const SampleRect rect{column, row, std::min(kTileSide, grid.width - column),
                          std::min(kTileSide, grid.height - row)};
    double heights[kTileSamples], less[kTileSamples] = {};
    float z[kTileSamples];
    form.readHeights(rect, heights, kTileSide);
    if (over != nullptr) over->readHeights(rect, less, kTileSide);
    constexpr auto kMost = static_cast<double>(std::numeric_limits<float>::max());
    for (int r = 0; r < rect.rows; ++r)
      for (int k = r * kTileSide; k < r * kTileSide + rect.columns; ++k)
        z[k] = static_cast<float>(std::clamp(heights[k] - less[k], -kMost, kMost));
    builder->writeHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  return std::move(*builder).build();
}

}  // namespace fettle::engine
