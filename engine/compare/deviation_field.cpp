#include "engine/compare/deviation_field.h"

#include <utility>

#include <fmt/format.h>

#include "engine/compare/tile_sums.h"
#include "engine/field/builder.h"

namespace fettle::engine {

Result<Version> deviationField(const Version& a, const Version& b, JobControl& job) {
  Grid grid = a.grid();
  if (grid.width != b.grid().width || grid.height != b.grid().height)
    return inputError(fmt::format("a field of {} x {} samples cannot be compared with one of {} x {}",
                                  grid.width, grid.height, b.grid().width, b.grid().height),
                      {}, "give two fields of one size");
  const double b_in_a = b.grid().height_unit.mm / grid.height_unit.mm;
  grid.height_per_count = 0.0;
  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), "the deviation");
  if (!builder) return tl::unexpected(builder.error());
  const FieldReader from = a.reader();
  const FieldReader to = b.reader();
  const auto tiles = static_cast<std::int64_t>(tileCount(from));
  job.begin("taking the difference", static_cast<std::uint64_t>(tiles));
  tbb::parallel_for(std::int64_t{0}, tiles, [&](std::int64_t i) {
    if (job.cancelled()) return;
    const SampleRect rect = tileRect(from, i);
    float za[kTileSamples];
    float zb[kTileSamples];
    from.readHeights(rect.column, rect.row, rect.columns, rect.rows, za, kTileSide);
    to.readHeights(rect.column, rect.row, rect.columns, rect.rows, zb, kTileSide);
    for (int r = 0; r < rect.rows; ++r)
      for (int k = r * kTileSide; k < r * kTileSide + rect.columns; ++k)
        za[k] = static_cast<float>(zb[k] * b_in_a - double{za[k]});
    builder->writeHeights(rect.column, rect.row, rect.columns, rect.rows, za, kTileSide);
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  return std::move(*builder).build();
}

}  // namespace fettle::engine
