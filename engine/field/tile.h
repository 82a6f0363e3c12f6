#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <type_traits>

namespace fettle::engine {

// The field is a tree with 8 x 8 children at every level, so that the table of tiles is also the min/max
// pyramid:
//
//   level 0   block    8 x 8 samples          bounds kept in the tile
//   level 1   tile    64 x 64 samples         bounds kept in its parent node (and in the tile)
//   level 2   node   512 x 512                8 x 8 tiles
//   level 3   node  4096 x 4096               8 x 8 nodes of level 2
//   level 4, 5      32768, 262144
//
// A one-sample edit re-bounds one block (64 samples), one tile (64 blocks) and, only while a bound changed,
// one entry per level above. Copy-on-write copies one tile and one small node per level.

inline constexpr int kBlockSide = 8;
inline constexpr int kTileSide = 64;
inline constexpr int kTileShift = 6;
inline constexpr int kTileSamples = kTileSide * kTileSide;
inline constexpr int kFanOut = 64;  // children of a node, blocks of a tile: 8 x 8, row-major

/// Lowest and highest height of some samples, holes left out; min > max when there is none.
struct HeightBounds {
  float min = 0.0F;
  float max = 0.0F;

  [[nodiscard]] bool empty() const noexcept { return !(min <= max); }
  friend bool operator==(const HeightBounds&, const HeightBounds&) = default;
};

/// 64 x 64 samples, their marks and their part of the min/max pyramid. Once shared between two versions a
/// tile is never written again.
///
/// `samples` is row-major, stride kTileSide, in the file's height unit, without the version's sign. NaN is a
/// hole; samples of a border tile that lie outside the field are NaN too. No infinity is ever stored.
struct alignas(64) Tile {
  std::array<float, kTileSamples> samples;
  /// Bit c of marks[r]: sample (c, r) is in the keep mask. Bits outside the field are 0.
  std::array<std::uint64_t, kTileSide> marks;
  std::array<float, kFanOut> block_min;  ///< of the 8 x 8 blocks, row-major; +inf where all are holes
  std::array<float, kFanOut> block_max;  ///< -inf where all are holes
  HeightBounds bounds;                   ///< of the whole tile
  std::uint32_t nan_samples;             ///< holes and samples outside the field
  std::uint32_t marked_samples;

  [[nodiscard]] bool marked(int column, int row) const noexcept {
    return ((marks[static_cast<std::size_t>(row)] >> column) & 1U) != 0;
  }
};
static_assert(std::is_trivially_copyable_v<Tile>);
static_assert(sizeof(Tile) <= kTileSamples * 4 + 1152, "the budget is 6 bytes per sample, all included");

/// Inner node of the tree: 8 x 8 children and their bounds. `children` point to Tiles in a node of level 2,
/// to Nodes of level - 1 above it; null outside the field.
struct alignas(64) Node {
  std::array<void*, kFanOut> children;
  std::array<float, kFanOut> child_min;
  std::array<float, kFanOut> child_max;
  std::uint64_t marked_children;  ///< bit k: some sample below child k is marked
  std::uint64_t holed_children;   ///< bit k: some sample of the field below child k is a hole
  std::int32_t level;
};
static_assert(std::is_trivially_copyable_v<Node>);

/// Recomputes the bounds of the blocks that the samples [column0, column1) x [row0, row1) of the tile touch,
/// then the tile's own. O(blocks touched). Exact, not only conservative.
void refreshBounds(Tile& tile, int column0, int row0, int column1, int row1) noexcept;

/// The tile's own bounds from those of its blocks.
void refreshTileBounds(Tile& tile) noexcept;

/// As refreshBounds after one sample changed, `old` is its previous value, and all bounds were correct before.
/// Returns whether the tile's own bounds changed.
[[nodiscard]] bool refreshSampleBounds(Tile& tile, int column, int row, float old) noexcept;

/// Recomputes the tile's count of marks.
void refreshMarks(Tile& tile) noexcept;

}  // namespace fettle::engine
