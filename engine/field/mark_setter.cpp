#include "engine/field/mark_setter.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "engine/field/tile.h"

namespace fettle::engine {

MarkSetter::MarkSetter(const Version& field)
    : live_(field, Growth::kAllowed), width_(field.grid().width), height_(field.grid().height) {
  strip_.resize(static_cast<std::size_t>(width_) * kTileSide);
}

bool MarkSetter::take(std::int32_t row, const unsigned char* mask) {
  std::memcpy(strip_.data() + static_cast<std::size_t>(row % kTileSide) * width_, mask,
              static_cast<std::size_t>(width_));
  return row % kTileSide != 0 || applyTileRow(row / kTileSide);
}

bool MarkSetter::applyTileRow(std::int32_t tr) {
  const std::int32_t rows = std::min(kTileSide, height_ - tr * kTileSide);
  for (std::int32_t tc = 0; tc * kTileSide < width_; ++tc) {
    const std::int32_t columns = std::min(kTileSide, width_ - tc * kTileSide);
    std::array<std::uint64_t, kTileSide> marks{};
    for (std::int32_t r = 0; r < rows; ++r) {
      const unsigned char* from = strip_.data() + static_cast<std::size_t>(r) * width_ + tc * kTileSide;
      for (std::int32_t c = 0; c < columns; ++c)
        marks[static_cast<std::size_t>(r)] |= std::uint64_t{from[c] != 0} << c;
    }
    const Tile& old = live_.reader().tile(tc, tr);
    if (old.marks == marks) continue;
    TileRef fresh = live_.newTile();
    if (!fresh) return false;
    *fresh = old;
    fresh->marks = marks;
    refreshMarks(*fresh);
    if (!live_.replaceTile(tc, tr, std::move(fresh))) return false;
  }
  return true;
}

}  // namespace fettle::engine
