#include "render/residency/page_table.h"

#include <algorithm>

namespace fettle::render {

PageGrid::PageGrid(std::int32_t width, std::int32_t height, int log2_side)
    : size_(width, height), log2_side_(log2_side) {
  for (int level = 0; level < kDataLevels; ++level) {
    first_[static_cast<std::size_t>(level)] = entries_;
    entries_ += pages(level).x * pages(level).y;
  }
  first_[kDataLevels] = entries_;
  rim_row_ = (height + engine::kTileSide - 1) / engine::kTileSide * engine::kTileSide;
  entries_ += ((rimSamples() - 1) >> (2 * log2_side_)) + 1;
}

PageGrid::Place PageGrid::place(int entry) const noexcept {
  int level = kDataLevels;
  while (level > 0 && entry < first(level)) --level;
  const int n = entry - first(level);
  if (level == kDataLevels) return {level, {n, 0}};
  const int across = pages(level).x;
  return {level, {n % across, n / across}};
}

PageGrid::Key PageGrid::key(int entry, const engine::FieldReader& reader) const noexcept {
  Key key{};
  const Place at = place(entry);
  if (at.level == kDataLevels) return key;
  // A page covers 2^log2_tiles tiles in each direction: 1, 2 or 4 nodes of 8^up tiles.
  const int log2_tiles = log2_side_ + dataShift(at.level) - engine::kTileShift;
  const int up = log2_tiles / 3, across = 1 << (log2_tiles - 3 * up);
  for (int k = 0; k < across * across; ++k) {
    const glm::ivec2 tile = (at.page * across + glm::ivec2(k % across, k / across)) << (3 * up);
    if (tile.x >= reader.tileColumns() || tile.y >= reader.tileRows()) continue;
    const engine::Node* node = &reader.root();
    while (node->level > up + 2)
      node = static_cast<const engine::Node*>(
          node->children[engine::FieldReader::childIndex(tile.x, tile.y, 3 * (node->level - 2))]);
    // A tree of fewer levels is the content of the page.
    key[static_cast<std::size_t>(k)] =
        node->level == up + 2
            ? node->children[engine::FieldReader::childIndex(tile.x, tile.y, 3 * (node->level - 2))]
            : node;
  }
  return key;
}

LevelSpan geometrySpan(int patch_level, glm::ivec2 patch, bool holed) noexcept {
  const int side = gpu::kPatchCells << patch_level, stride = 1 << patch_level;
  const int log2_step = holed ? std::max(patch_level - 3, 0) : patch_level;
  const int level = std::min(log2_step / 2, kDataLevels - 1), reach = holed ? stride : 0;
  const glm::ivec2 first = patch * side;
  return {level, (first - reach) >> dataShift(level), (first + side + reach) >> dataShift(level)};
}

LevelSpan shadeSpan(int patch_level, glm::ivec2 patch, int level, int step) noexcept {
  const int side = gpu::kPatchCells << patch_level;
  // The corners of a cell, one sample next to them, and differences to samples `step` beyond a corner.
  const int reach = 2 + step;
  const glm::ivec2 first = patch * side;
  return {level, (first >> dataShift(level)) - reach, ((first + side) >> dataShift(level)) + reach};
}

}  // namespace fettle::render
