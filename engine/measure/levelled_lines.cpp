#include "engine/measure/levelled_lines.h"

#include <algorithm>
#include <cstdint>

namespace fettle::engine {

Status levelLines(const Version& field, const LineOffsets& offsets, const TileRange& tiles, LiveField& to,
                  JobControl& job) {
  const FieldReader reader = field.reader();
  job.begin("levelling lines", static_cast<std::uint64_t>(tiles.rows));
  float z[kTileSamples];
  double taken[kTileSamples];
  for (std::int32_t tr = tiles.row; tr < tiles.row + tiles.rows; ++tr) {
    if (job.cancelled()) return cancelled();
    for (std::int32_t tc = tiles.column; tc < tiles.column + tiles.columns; ++tc) {
      const std::int32_t column = tc * kTileSide, row = tr * kTileSide;
      const SampleRect rect{column, row, std::min(kTileSide, reader.width() - column),
                            std::min(kTileSide, reader.height() - row)};
      reader.readHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
      offsets.readHeights(rect, taken);
      for (int r = 0; r < rect.rows; ++r)
        for (int k = r * kTileSide; k < r * kTileSide + rect.columns; ++k)
          z[k] = static_cast<float>(z[k] - taken[k]);
      if (!to.writeHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide))
        return failure("there is not enough memory for the levelled field", "level",
                       "keep the samples on a disk with --store FOLDER");
    }
    job.advance();
  }
  return {};
}

Result<Version> levelledLines(const Version& field, const LineOffsets& offsets, const TileRange& tiles,
                              JobControl& job) {
  LiveField live(field, Growth::kAllowed);
  if (auto levelled = levelLines(field, offsets, tiles, live, job); !levelled)
    return tl::unexpected(levelled.error());
  return live.snapshot();
}

}  // namespace fettle::engine
