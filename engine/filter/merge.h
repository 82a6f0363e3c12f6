#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/field/tile.h"
#include "engine/filter/filter.h"
#include "engine/simd/cpu.h"

namespace fettle::engine {

/// What happened to one tile, for FilterReport.
struct TileReport {
  std::int64_t changed = 0;
  double max_change = 0.0;
  double squares = 0.0;  ///< of the changes; added up in a fixed order
};

/// after = before, with the results where they may act: not at holes, and only where the marks allow it; a
/// result equal to the sample leaves its very bits, and a new zero is the positive one. Fills samples, marks,
/// bounds and counts of `after` in one pass over the samples, and compares the two in the same pass.
///
/// results: kTileSide x kTileSide, row-major, stride in elements, of the version's sign (1 or -1) while tiles
/// are stored without; read everywhere, unspecified at holes and outside the field. ahead: a tile that is
/// read soon; its samples are fetched meanwhile. Null: none.
[[nodiscard]] TileReport mergeTile(const Tile& before, const float* results, std::ptrdiff_t stride,
                                   float sign, FilterScope scope, Tile& after, CpuLevel level,
                                   const Tile* ahead = nullptr) noexcept;

/// The change from one tile to another, over the samples that are holes in neither.
[[nodiscard]] TileReport compareTiles(const Tile& before, const Tile& after, CpuLevel level) noexcept;

}  // namespace fettle::engine
