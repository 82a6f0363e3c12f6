#include "haptic/loop/adoption.h"

#include <algorithm>
#include <tuple>

#include "engine/field/difference.h"
#include "engine/field/live_field.h"

namespace fettle::haptic {

engine::Result<MergedResult> mergeResult(const engine::Version& now, const engine::Version& base,
                                         const engine::Version& result) {
  engine::LiveField merged(now, engine::Growth::kAllowed);
  const engine::FieldReader present = now.reader();
  MergedResult out;
  for (engine::TileChange& change : engine::changedTiles(base, result)) {
    if (&present.tile(change.tile_column, change.tile_row) != change.before.get())
      out.conflicts.push_back({change.tile_column, change.tile_row});
    else if (!merged.replaceTile(change.tile_column, change.tile_row, std::move(change.after)))
      return engine::failure("memory for the filtered tiles could not be allocated",
                             "adopting a filter's result", "close other programs or filter a smaller field");
  }
  out.version = merged.snapshot();
  return out;
}

std::vector<TileSpot> withHalo(const std::vector<TileSpot>& edited, std::int32_t reach_samples,
                               const engine::Grid& grid) {
  const std::int32_t columns = (grid.width + engine::kTileSide - 1) / engine::kTileSide;
  const std::int32_t rows = (grid.height + engine::kTileSide - 1) / engine::kTileSide;
  const std::int32_t reach = (reach_samples + engine::kTileSide - 1) / engine::kTileSide;
  std::vector<TileSpot> all;
  for (const TileSpot& spot : edited)
    for (std::int32_t r = std::max(spot.row - reach, 0); r <= std::min(spot.row + reach, rows - 1); ++r)
      for (std::int32_t c = std::max(spot.column - reach, 0); c <= std::min(spot.column + reach, columns - 1);
           ++c)
        all.push_back({c, r});
  const auto key = [](const TileSpot& t) { return std::tuple(t.row, t.column); };
  std::sort(all.begin(), all.end(), [&](const TileSpot& a, const TileSpot& b) { return key(a) < key(b); });
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace fettle::haptic
