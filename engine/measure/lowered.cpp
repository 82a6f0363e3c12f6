#include "engine/measure/lowered.h"

#include <cstdint>
#include <utility>

#include <tbb/parallel_for.h>

#include "engine/compare/tile_sums.h"
#include "engine/field/builder.h"

namespace fettle::engine {

Result<Version> lowered(const Version& field, const char* stage, const HeightsOf& heights, JobControl& job) {
  Grid grid = field.grid();
  grid.height_per_count = 0.0;
  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), "the levelled field");
  if (!builder) return tl::unexpected(builder.error());
  const FieldReader from = field.reader();
  const auto tiles = static_cast<std::int64_t>(tileCount(from));
  job.begin(stage, static_cast<std::uint64_t>(tiles));
  tbb::parallel_for(std::int64_t{0}, tiles, [&](std::int64_t i) {
    if (job.cancelled()) return;
    const SampleRect rect = tileRect(from, i);
    float z[kTileSamples];
    double taken[kTileSamples];
    std::uint8_t marks[kTileSamples];
    from.readHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
    from.readMarks(rect.column, rect.row, rect.columns, rect.rows, marks, kTileSide);
    heights(rect, taken);
    for (int r = 0; r < rect.rows; ++r)
      for (int k = r * kTileSide; k < r * kTileSide + rect.columns; ++k)
        z[k] = static_cast<float>(z[k] - taken[k]);
    builder->writeHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
    builder->writeMarks(rect.column, rect.row, rect.columns, rect.rows, marks, kTileSide);
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  return std::move(*builder).build().withLines(field.lines());
}

}  // namespace fettle::engine
