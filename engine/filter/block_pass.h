#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "engine/field/node_pool.h"
#include "engine/field/tile.h"
#include "engine/field/version.h"
#include "engine/filter/block.h"
#include "engine/filter/merge.h"
#include "engine/filter/pass.h"
#include "engine/filter/tile_window.h"

namespace fettle::engine {

/// Tiles [column0, column1) x [row0, row1).
struct TileRect {
  std::int32_t column0, row0, column1, row1;
  [[nodiscard]] bool empty() const noexcept { return column0 >= column1 || row0 >= row1; }
};

/// A tile that differs from the one at its place.
struct NewTile {
  std::int32_t column, row;
  TileRef tile;
  TileReport report;
};

/// The samples of one block and the results for it; follows the block's size.
struct BlockScratch {
  std::vector<float> heights, out;
  std::ptrdiff_t out_stride = 0;
  alignas(64) std::array<float, kTileSamples> one_tile, results;
};

/// What one pass over a field in blocks of tiles does around the filter: which tiles may change, the samples that a
/// block needs, and its results as new tiles.
///
/// Threading: all but the constructor from any number of threads, each with its own scratch and its own list of tiles.
class BlockPass {
 public:
  /// A filter whose results depend on the samples within `radius`; a block gets those within `halo`. `input`,
  /// `original` and `spec` outlive this.
  BlockPass(const Version& input, const Version& original, const FilterSpec& spec, int radius, int halo,
            CpuLevel level);

  [[nodiscard]] const FieldReader& reader() const noexcept { return reader_; }
  [[nodiscard]] const LineCuts* cuts() const noexcept { return cuts_; }
  [[nodiscard]] CpuLevel level() const noexcept { return level_; }

  /// The smallest rectangle of tiles in `rect` that holds all in which any sample can come out different.
  [[nodiscard]] TileRect toChange(const TileRect& rect) const noexcept;

  [[nodiscard]] bool mayChange(std::int32_t tc, std::int32_t tr) const noexcept;

  /// Samples of a rectangle of tiles.
  [[nodiscard]] std::int64_t samplesOf(const TileRect& rect) const noexcept;

  /// The block whose outputs are these tiles, in the scratch.
  [[nodiscard]] Block gather(const TileRect& rect, BlockScratch& scratch) const;

  /// Merges scratch.out, which has the sign `sign`, into the tiles of a rectangle; appends those that changed. Fetches
  /// the tiles that lie `to_next` further meanwhile, if any. False when memory is exhausted.
  bool merge(const TileRect& rect, float sign, std::int32_t to_next, BlockScratch& scratch,
             std::vector<NewTile>& made);

  /// The tile and those around it, when all of these lie in the field and none has a hole.
  [[nodiscard]] std::optional<TileAround> around(std::int32_t tc, std::int32_t tr) const noexcept;

  /// Merges scratch.results, as stored, into one tile, as merge does.
  bool mergeTileAt(std::int32_t tc, std::int32_t tr, BlockScratch& scratch, std::vector<NewTile>& made);

  /// Whether a merge found no memory.
  [[nodiscard]] bool outOfMemory() const noexcept { return out_of_memory_.load(std::memory_order_relaxed); }

  /// The input with all tiles that were made, in any order. Error kFailed: out of memory.
  [[nodiscard]] Result<PassResult> finish(std::vector<NewTile> tiles) const;

 private:
  [[nodiscard]] bool flatAround(std::int32_t tc, std::int32_t tr, float height) const noexcept;
  [[nodiscard]] std::pair<int, int> extent(std::int32_t tc, std::int32_t tr) const noexcept;
  void surveyTiles(std::int32_t column, std::int32_t row, Block& block) const noexcept;
  bool mergeOne(std::int32_t tc, std::int32_t tr, const float* results, float sign, const Tile* ahead,
                BlockScratch& scratch, std::vector<NewTile>& made);
  void clampToOriginal(std::int32_t tc, std::int32_t tr, const float* results, std::ptrdiff_t stride,
                       float sign, float* stored) const noexcept;

  const Version& input_;
  FieldMemory& memory_;
  FieldReader reader_;
  FieldReader original_;
  const FilterSpec& spec_;
  int radius_, halo_;
  bool same_field_;
  CpuLevel level_;
  const LineCuts* cuts_;  // null without lines
  std::atomic<bool> out_of_memory_{false};
};

}  // namespace fettle::engine
