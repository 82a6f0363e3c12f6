#include "engine/filter/region.h"

#include <algorithm>
#include <new>
#include <vector>

#include "engine/field/live_field.h"
#include "engine/field/piece.h"
#include "engine/filter/catalogue.h"

namespace fettle::engine {

namespace {

tl::unexpected<Error> noMemory() {
  return failure("memory for filtering could not be had", "filter", "filter a smaller part");
}

// With the sign of the field: some filters ask for the heights of the scan itself.
Version piece(const Version& field, const SampleRect& rect) {
  if (field.reader().sign() > 0.0F) return pieceOf(field, rect.column, rect.row, rect.columns, rect.rows);
  return pieceOf(field.inverted(), rect.column, rect.row, rect.columns, rect.rows).inverted();
}

}  // namespace

Result<Version> filterRange(const Version& input, const Version& original, const Version& onto,
                            const FilterSpec& spec, TileRange range, JobControl& job) try {
  if (Status valid = validate(spec); !valid) return tl::unexpected(valid.error());
  const Grid& grid = input.grid();
  const TileRange all = allTiles(grid);
  const std::int32_t tc0 = std::max(range.column, 0), tr0 = std::max(range.row, 0);
  const std::int32_t tc1 = std::min(range.column + range.columns, all.columns);
  const std::int32_t tr1 = std::min(range.row + range.rows, all.rows);
  if (tc0 >= tc1 || tr0 >= tr1) return onto;
  const std::int64_t reach = reachOf(spec, input);
  const std::int64_t aligned = pieceGridOf(spec, grid);
  // A reach may be half a million samples: cut in 64 bits.
  const auto low = [&](std::int32_t tile) {
    const std::int64_t first = std::max<std::int64_t>(std::int64_t{tile} * kTileSide - reach, 0);
    return static_cast<std::int32_t>(first - first % aligned);
  };
  const auto high = [&](std::int32_t tile, std::int32_t side) {
    return static_cast<std::int32_t>(std::min<std::int64_t>(std::int64_t{tile} * kTileSide + reach, side));
  };
  SampleRect around{low(tc0), low(tr0), high(tc1, grid.width), high(tr1, grid.height)};
  around.columns -= around.column;
  around.rows -= around.row;
  const Version part = piece(input, around);
  // The original is only read where the change is measured against it.
  const bool same_sign = input.reader().sign() == original.reader().sign();
  const Version part_original =
      spec.max_change ? piece(same_sign ? original : original.inverted(), around) : part;
  const Result<Filtered> done = applyFilter(part, part_original, spec, job);
  if (!done) return tl::unexpected(done.error());
  LiveField out(onto, Growth::kAllowed);
  std::vector<float> heights(kTileSamples);
  for (std::int32_t tr = tr0; tr < tr1; ++tr)
    for (std::int32_t tc = tc0; tc < tc1; ++tc) {
      const std::int32_t c = tc * kTileSide, r = tr * kTileSide;
      const std::int32_t columns = std::min(kTileSide, grid.width - c),
                         rows = std::min(kTileSide, grid.height - r);
      done->field.reader().readHeights(c - around.column, r - around.row, columns, rows, heights.data(),
                                       kTileSide);
      if (!out.writeHeights(c, r, columns, rows, heights.data(), kTileSide)) return noMemory();
    }
  return out.snapshot();
} catch (const std::bad_alloc&) {
  return noMemory();
}

}  // namespace fettle::engine
