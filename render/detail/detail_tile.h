#pragma once

#include <glm/vec2.hpp>

#include "engine/field/tile.h"
#include "render/detail/detail.h"

namespace fettle::render {

/// Height of a vertex for which no sample was found, on the rings around it either.
inline constexpr float kMissingVertex = 1e30F;

/// A tile's samples and the first ones of the tiles above and to the right: kTileRows rows of as many
/// columns, each row kTileStride elements long. Outside the field or the row: NaN.
inline constexpr int kTileRows = engine::kTileSide + 1;
inline constexpr int kTileStride = (kTileRows + 7) / 8 * 8;  // whole vectors of 8

/// Lowest and highest sample of each cell of one level in a tile, corners included, and whether some sample
/// of it is a hole. Cell (i, j) is number j * kMost + i.
struct TileExtremes {
  static constexpr int kMost = engine::kTileSide / 2;

  /// Of level 1. `cells`: how many cells of level 0 the tile has, 1 .. 64 in each direction.
  void ofSamples(const float* heights, glm::ivec2 cells);
  /// Of the next level.
  void coarsen();

  glm::ivec2 count{0, 0};        ///< cells across and up
  float lowest[kMost * kMost];   ///< +infinity where all are holes
  float highest[kMost * kMost];  ///< -infinity where all are holes
  float hole[kMost * kMost];     ///< > 0: some sample is a hole
  float largest = 0.0F;          ///< magnitude of a height of the tile
};

/// The errors of the cells of level k, cut into squares of `patch_cells` cells of that level (or fewer, where
/// the tile is smaller), row-major with `across` squares a row, of a tile that has `cells` cells of level 0.
/// `extremes` are of level k. `vertices`: heights at the vertices of this level, kMissingVertex where there
/// is none; row-major, (64 >> k) + 1 per row.
void measureTileLevel(const float* heights, glm::ivec2 cells, int level, const float* vertices,
                      const TileExtremes& extremes, int patch_cells, int across, DetailMeasure::Error* out);

}  // namespace fettle::render
