#include "haptic/loop/edits_since.h"

namespace fettle::haptic {

void EditsSince::add(const engine::SampleRect& rect) noexcept {
  using engine::kTileShift;
  if (!valid_) return;
  for (std::int32_t r = rect.row >> kTileShift; r <= (rect.row + rect.rows - 1) >> kTileShift; ++r)
    for (std::int32_t c = rect.column >> kTileShift; c <= (rect.column + rect.columns - 1) >> kTileShift;
         ++c) {
      // Starting with the newest: consecutive ticks edit the same tiles.
      int i = count_ - 1;
      while (i >= 0 && !(tiles_[static_cast<std::size_t>(i)].column == c &&
                         tiles_[static_cast<std::size_t>(i)].row == r))
        --i;
      if (i >= 0) continue;
      if (count_ == kMostTiles) {
        drop();
        return;
      }
      tiles_[static_cast<std::size_t>(count_++)] = {c, r};
    }
}

int EditsSince::carryInto(engine::LiveField& field, const engine::Version& live) const noexcept {
  const engine::FieldReader now = live.reader();
  const engine::FieldReader base = base_.reader();
  int carried = 0;
  for (int i = 0; i < count_; ++i) {
    const TileIndex t = tiles_[static_cast<std::size_t>(i)];
    const engine::Tile* tile = &now.tile(t.column, t.row);
    // The base holds its tiles, so the same address is the same tile, unchanged.
    if (tile == &base.tile(t.column, t.row)) continue;
    if (!field.replaceTile(t.column, t.row, engine::TileRef::share(tile))) return -1;
    ++carried;
  }
  return carried;
}

}  // namespace fettle::haptic
