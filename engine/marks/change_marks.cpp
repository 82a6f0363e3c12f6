#include "engine/marks/change_marks.h"

#include <algorithm>
#include <atomic>
#include <new>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "engine/field/live_field.h"

namespace fettle::engine {

namespace {

struct FreshTile {
  std::int32_t column, row;
  TileRef tile;
};

tl::unexpected<Error> noMemoryForMarks() {
  return failure("memory for the marks could not be allocated", "", "close other programs");
}

// The bits of row `row` of the tile that lie in the field.
std::uint64_t inField(const Grid& grid, std::int32_t tc, std::int32_t tr, int row) noexcept {
  if (tr * kTileSide + row >= grid.height) return 0;
  const int columns = std::min(kTileSide, grid.width - tc * kTileSide);
  return columns == kTileSide ? ~std::uint64_t{0} : (std::uint64_t{1} << columns) - 1;
}

}  // namespace

Result<Version> changeMarks(const Version& field, TileRange range, const TileMarking& marking,
                            JobControl& job) try {
  const FieldReader reader = field.reader();
  const Grid& grid = field.grid();
  const std::int32_t c0 = std::max(range.column, 0), r0 = std::max(range.row, 0);
  const std::int32_t c1 = std::min(range.column + range.columns, reader.tileColumns());
  const std::int32_t r1 = std::min(range.row + range.rows, reader.tileRows());
  const std::int64_t across = std::max(c1 - c0, 0), up = std::max(r1 - r0, 0);
  job.begin("marking", static_cast<std::uint64_t>(across * up));
  tbb::enumerable_thread_specific<std::vector<FreshTile>> made;
  std::atomic<bool> pool_empty{false};
  tbb::parallel_for(std::int64_t{0}, across * up, [&](std::int64_t i) {
    // Relaxed: read again after the join.
    if (job.cancelled() || pool_empty.load(std::memory_order_relaxed)) return;
    const auto tc = c0 + static_cast<std::int32_t>(i % across);
    const auto tr = r0 + static_cast<std::int32_t>(i / across);
    const Tile& old = reader.tile(tc, tr);
    MarkRows rows = old.marks;
    marking(tc, tr, old, rows);
    for (int r = 0; r < kTileSide; ++r) rows[static_cast<std::size_t>(r)] &= inField(grid, tc, tr, r);
    job.advance();
    if (rows == old.marks) return;
    TileRef fresh = TileRef::adopt(field.memory()->bulk().acquire());
    if (!fresh) {
      pool_empty.store(true, std::memory_order_relaxed);
      return;
    }
    *fresh = old;
    fresh->marks = rows;
    refreshMarks(*fresh);
    made.local().push_back({tc, tr, std::move(fresh)});
  });
  if (job.cancelled()) return cancelled();
  if (pool_empty.load(std::memory_order_relaxed)) return noMemoryForMarks();
  LiveField live(field, Growth::kAllowed);
  for (std::vector<FreshTile>& tiles : made)
    for (FreshTile& t : tiles)
      if (!live.replaceTile(t.column, t.row, std::move(t.tile))) return noMemoryForMarks();
  return live.snapshot();
} catch (const std::bad_alloc&) {
  return noMemoryForMarks();
}

Result<Version> clearMarks(const Version& field, JobControl& job) {
  return changeMarks(
      field, allTiles(field.grid()),
      [](std::int32_t, std::int32_t, const Tile&, MarkRows& rows) { rows.fill(0); }, job);
}

Result<Version> invertMarks(const Version& field, JobControl& job) {
  return changeMarks(
      field, allTiles(field.grid()),
      [](std::int32_t, std::int32_t, const Tile& tile, MarkRows& rows) {
        MarkRows others;
        for (std::size_t r = 0; r < rows.size(); ++r) others[r] = ~rows[r];
        rows.fill(0);
        applyChange(tile, others, MarkChange::kMark, rows);
      },
      job);
}

}  // namespace fettle::engine
