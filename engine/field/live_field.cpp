#include "engine/field/live_field.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace fettle::engine {

namespace {

// The bit pattern that is stored for a height: sign off, infinities and every kind of NaN as one hole.
// Negated and not multiplied, since the haptic thread flushes denormals: a sample that is written back
// unchanged keeps its bits.
float stored(float height, float sign) noexcept {
  if (!std::isfinite(height)) return std::numeric_limits<float>::quiet_NaN();
  return sign < 0.0F ? -height : height;
}

}  // namespace

LiveField::LiveField(Version start, Growth growth) noexcept : state_(std::move(start)), growth_(growth) {
  assert(!state_.empty());
}

Version LiveField::adopt(Version version) noexcept {
  assert(version.grid().width == grid().width && version.grid().height == grid().height);
  std::swap(state_.root_, version.root_);
  std::swap(state_.sign_, version.sign_);
  state_.description_.swap(version.description_);
  state_.memory_.swap(version.memory_);
  return version;
}

TileRef LiveField::newTile() noexcept {
  // A writer that may grow a pool may wait for a disk as well.
  FieldMemory& memory = *state_.memory_;
  TileRef tile =
      TileRef::adopt(growth_ == Growth::kAllowed ? memory.bulk().acquire() : memory.tiles.tryAcquire());
  if (!tile) ++refused_;
  return tile;
}

// Makes this field the only owner of the node in `slot`, copying it if a version shares it. Null when the
// pool is empty.
Node* LiveField::ownNode(Node*& slot) noexcept {
  if (InnerPool::unique(slot)) return slot;
  InnerPool& pool = state_.memory_->nodes;
  Node* copy = growth_ == Growth::kAllowed ? pool.acquire() : pool.tryAcquire();
  if (copy == nullptr) return nullptr;
  *copy = *slot;
  for (void* child : copy->children) {
    if (child == nullptr) continue;
    if (copy->level == 2)
      TilePool::retain(static_cast<const Tile*>(child));
    else
      InnerPool::retain(static_cast<const Node*>(child));
  }
  // The shared node remains in the version that shares it, unless that version was dropped between the two
  // lines above; then this frees it, and with it only what the copy does not hold.
  releaseNode(slot);
  slot = copy;
  return copy;
}

bool LiveField::ownNodes(std::int32_t tc, std::int32_t tr, Path& path) noexcept {
  path.depth = 0;
  Node* node = ownNode(state_.root_);
  while (node != nullptr) {
    path.nodes[path.depth++] = node;
    if (node->level == 2) return true;
    const std::size_t k = FieldReader::childIndex(tc, tr, 3 * (node->level - 2));
    Node* child = static_cast<Node*>(node->children[k]);
    Node* owned = ownNode(child);
    node->children[k] = child;
    node = owned;
  }
  ++refused_;
  return false;
}

bool LiveField::ownTile(std::int32_t tc, std::int32_t tr, Path& path) noexcept {
  if (!ownNodes(tc, tr, path)) return false;
  void*& slot = path.nodes[path.depth - 1]->children[FieldReader::childIndex(tc, tr, 0)];
  path.tile = static_cast<Tile*>(slot);
  if (TilePool::unique(path.tile)) return true;
  TileRef copy = newTile();
  if (!copy) return false;
  *copy = *path.tile;
  releaseTile(path.tile);
  path.tile = copy.detach();
  slot = path.tile;
  return true;
}

bool LiveField::tileHoled(const Tile& tile, std::int32_t tc, std::int32_t tr) const noexcept {
  const int columns = std::min(kTileSide, grid().width - tc * kTileSide);
  const int rows = std::min(kTileSide, grid().height - tr * kTileSide);
  return tile.nan_samples > static_cast<std::uint32_t>(kTileSamples - columns * rows);
}

// Propagates the tile's bounds and flags up the path, until a level does not change.
void LiveField::publish(const Path& path, std::int32_t tc, std::int32_t tr, bool holed) noexcept {
  HeightBounds bounds = path.tile->bounds;
  bool marked = path.tile->marked_samples != 0;
  for (int d = path.depth - 1; d >= 0; --d) {
    Node& node = *path.nodes[d];
    const std::size_t k = FieldReader::childIndex(tc, tr, 3 * (node.level - 2));
    const std::uint64_t bit = std::uint64_t{1} << k;
    const std::uint64_t marked_children = marked ? node.marked_children | bit : node.marked_children & ~bit;
    const std::uint64_t holed_children = holed ? node.holed_children | bit : node.holed_children & ~bit;
    if (node.child_min[k] == bounds.min && node.child_max[k] == bounds.max &&
        marked_children == node.marked_children && holed_children == node.holed_children)
      return;
    node.child_min[k] = bounds.min;
    node.child_max[k] = bounds.max;
    node.marked_children = marked_children;
    node.holed_children = holed_children;
    bounds = {*std::min_element(node.child_min.begin(), node.child_min.end()),
              *std::max_element(node.child_max.begin(), node.child_max.end())};
    marked = marked_children != 0;
    holed = holed_children != 0;
  }
}

bool LiveField::writeHeights(std::int32_t column, std::int32_t row, std::int32_t columns, std::int32_t rows,
                             const float* heights, std::ptrdiff_t stride) noexcept {
  assert(columns > 0 && rows > 0 && column >= 0 && row >= 0 && column + columns <= grid().width &&
         row + rows <= grid().height);
  const float sign = state_.sign_;
  const std::int32_t tc0 = column >> kTileShift;
  const std::int32_t tc1 = (column + columns - 1) >> kTileShift;
  const std::int32_t tr0 = row >> kTileShift;
  const std::int32_t tr1 = (row + rows - 1) >> kTileShift;

  // Two passes when the rectangle touches several tiles: first make all of them unshared, then write, so that
  // an empty pool leaves the field unchanged.
  const bool several = tc1 > tc0 || tr1 > tr0;
  for (int pass = several ? 0 : 1; pass < 2; ++pass)
    for (std::int32_t tr = tr0; tr <= tr1; ++tr)
      for (std::int32_t tc = tc0; tc <= tc1; ++tc) {
        const int c0 = std::max(column - tc * kTileSide, 0);
        const int r0 = std::max(row - tr * kTileSide, 0);
        const int c1 = std::min(column + columns - tc * kTileSide, kTileSide);
        const int r1 = std::min(row + rows - tr * kTileSide, kTileSide);
        const float* from = heights + (tr * kTileSide + r0 - row) * stride + (tc * kTileSide + c0 - column);

        const Tile& now = state_.reader().tile(tc, tr);
        bool differs = false;
        for (int r = r0; r < r1 && !differs; ++r)
          for (int c = c0; c < c1 && !differs; ++c) {
            const float z = stored(from[(r - r0) * stride + c - c0], sign);
            const float old = now.samples[r * kTileSide + c];
            differs = std::bit_cast<std::uint32_t>(z) != std::bit_cast<std::uint32_t>(old) &&
                      !(std::isnan(z) && std::isnan(old));
          }
        if (!differs) continue;

        Path path;
        if (!ownTile(tc, tr, path)) return false;
        if (pass == 0) continue;
        Tile& tile = *path.tile;
        std::int32_t nan_change = 0;
        for (int r = r0; r < r1; ++r)
          for (int c = c0; c < c1; ++c) {
            float& sample = tile.samples[r * kTileSide + c];
            const float z = stored(from[(r - r0) * stride + c - c0], sign);
            nan_change += static_cast<int>(std::isnan(z)) - static_cast<int>(std::isnan(sample));
            sample = z;
          }
        tile.nan_samples =
            static_cast<std::uint32_t>(static_cast<std::int32_t>(tile.nan_samples) + nan_change);
        refreshBounds(tile, c0, r0, c1, r1);
        publish(path, tc, tr, tileHoled(tile, tc, tr));
      }
  return true;
}

// Called at the rate of the loop: writeHeights of one sample, which touches one tile and rarely a bound.
bool LiveField::setHeight(std::int32_t column, std::int32_t row, float height) noexcept {
  assert(grid().contains(column, row));
  const std::int32_t tc = column >> kTileShift;
  const std::int32_t tr = row >> kTileShift;
  const int c = column & (kTileSide - 1);
  const int r = row & (kTileSide - 1);
  const auto at = static_cast<std::size_t>(r * kTileSide + c);
  const float z = stored(height, state_.sign_);
  const float old = state_.reader().tile(tc, tr).samples[at];
  if (std::bit_cast<std::uint32_t>(z) == std::bit_cast<std::uint32_t>(old) ||
      (std::isnan(z) && std::isnan(old)))
    return true;
  Path path;
  if (!ownTile(tc, tr, path)) return false;
  Tile& tile = *path.tile;
  tile.samples[at] = z;
  const int nan_change = static_cast<int>(std::isnan(z)) - static_cast<int>(std::isnan(old));
  tile.nan_samples += static_cast<std::uint32_t>(nan_change);
  if (refreshSampleBounds(tile, c, r, old) || nan_change != 0) publish(path, tc, tr, tileHoled(tile, tc, tr));
  return true;
}

bool LiveField::setMark(std::int32_t column, std::int32_t row, bool marked) noexcept {
  assert(grid().contains(column, row));
  const std::int32_t tc = column >> kTileShift;
  const std::int32_t tr = row >> kTileShift;
  const int c = column & (kTileSide - 1);
  const int r = row & (kTileSide - 1);
  if (state_.reader().tile(tc, tr).marked(c, r) == marked) return true;
  Path path;
  if (!ownTile(tc, tr, path)) return false;
  path.tile->marks[static_cast<std::size_t>(r)] ^= std::uint64_t{1} << c;
  path.tile->marked_samples += marked ? 1U : ~0U;
  publish(path, tc, tr, tileHoled(*path.tile, tc, tr));
  return true;
}

bool LiveField::replaceTile(std::int32_t tc, std::int32_t tr, TileRef tile) noexcept {
  Path path;
  if (!ownNodes(tc, tr, path)) return false;
  void*& slot = path.nodes[path.depth - 1]->children[FieldReader::childIndex(tc, tr, 0)];
  releaseTile(static_cast<Tile*>(slot));
  path.tile = tile.detach();
  slot = path.tile;
  publish(path, tc, tr, tileHoled(*path.tile, tc, tr));
  return true;
}

}  // namespace fettle::engine
