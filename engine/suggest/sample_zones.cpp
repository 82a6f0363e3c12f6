#include "engine/suggest/sample_zones.h"

#include <cstddef>

#include "engine/compare/compare.h"
#include "engine/compare/mark_distance.h"
#include "engine/compare/tile_sums.h"

namespace fettle::engine {

std::vector<SampleZone> zonesBesideMarks(const Version& edges) {
  const FieldReader reader = edges.reader();
  const TruthOptions options;
  const auto squared = [](double distance) { return distance * distance; };
  std::vector<SampleZone> zones(static_cast<std::size_t>(edges.grid().samples()));
  MarkDistance distance(static_cast<int>(options.flat));
  const std::int64_t tiles = std::int64_t{reader.tileColumns()} * reader.tileRows();
  for (std::int64_t tile = 0; tile < tiles; ++tile) {
    const SampleRect rect = tileRect(reader, tile);
    const std::vector<int>& to_edge = distance.measure(reader, rect);
    for (std::int32_t r = 0; r < rect.rows; ++r)
      for (std::int32_t c = 0; c < rect.columns; ++c) {
        const double d2 = to_edge[static_cast<std::size_t>(r * kTileSide + c)];
        zones[static_cast<std::size_t>(rect.row + r) * static_cast<std::size_t>(reader.width()) +
              static_cast<std::size_t>(rect.column + c)] =
            d2 <= squared(options.near_edge) ? SampleZone::kEdge
            : d2 > squared(options.flat)     ? SampleZone::kFlat
                                             : SampleZone::kBetween;
      }
  }
  return zones;
}

}  // namespace fettle::engine
