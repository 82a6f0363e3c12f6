#include "engine/compare/mark_distance.h"

#include <algorithm>
#include <cstddef>

#include "engine/field/tile.h"

namespace fettle::engine {

const std::vector<int>& MarkDistance::measure(const FieldReader& marks, const SampleRect& rect) {
  const int side = kTileSide + 2 * reach_;
  marks_.resize(static_cast<std::size_t>(side) * side);
  along_.assign(static_cast<std::size_t>(side) * kTileSide, kFar);
  squared_.assign(kTileSamples, kFar);
  marks.readMarks(rect.column - reach_, rect.row - reach_, side, side, marks_.data(), side);
  if (std::find(marks_.begin(), marks_.end(), 1) == marks_.end()) return squared_;
  for (int r = 0; r < side; ++r) {
    const std::uint8_t* row = marks_.data() + static_cast<std::ptrdiff_t>(r) * side;
    for (int c = 0; c < rect.columns; ++c)
      for (int d = 0; d <= reach_; ++d)
        if (row[c + reach_ - d] != 0 || row[c + reach_ + d] != 0) {
          along_[static_cast<std::size_t>(r * kTileSide + c)] = d * d;
          break;
        }
  }
  for (int r = 0; r < rect.rows; ++r)
    for (int dr = -reach_; dr <= reach_; ++dr)
      for (int c = 0; c < rect.columns; ++c) {
        const int a = along_[static_cast<std::size_t>((r + reach_ + dr) * kTileSide + c)];
        int& best = squared_[static_cast<std::size_t>(r * kTileSide + c)];
        if (a != kFar) best = std::min(best, a + dr * dr);
      }
  return squared_;
}

}  // namespace fettle::engine
