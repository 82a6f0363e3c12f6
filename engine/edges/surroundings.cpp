#include "engine/edges/surroundings.h"

#include <algorithm>
#include <cmath>

namespace fettle::engine {

namespace {

constexpr double kLeastApart = 0.25;  // of two breaks [samples]
constexpr double kGuard = 0.75;       // samples this near to a known line may lie on either of its sides
constexpr double kSameEdge = 0.5;     // [samples]
constexpr double kOwnRange = 1.0;     // left to a line between known ones whose error is as large

void cutLeft(OffsetRange& range, double offset) {
  range.low = std::max(range.low, offset);
}
void cutRight(OffsetRange& range, double offset) {
  range.high = std::min(range.high, offset);
}

// The samples from a known line on, its guard included, belong to it. `own_range`: at least kOwnRange stays.
void leaveTo(double offset, bool left, bool own_range, OffsetRange& range) {
  if (left)
    cutLeft(range, own_range ? std::min(-kOwnRange, offset + kGuard) : offset + kGuard);
  else
    cutRight(range, own_range ? std::max(kOwnRange, offset - kGuard) : offset - kGuard);
}

}  // namespace

std::vector<Surroundings> surroundingsOf(const Polyline& line, const LineNeighbours& neighbours, Stage stage,
                                         bool own_strong, const std::vector<bool>& strong) {
  std::vector<Surroundings> all(line.points.size());
  for (int i = 0; i < line.size(); ++i) {
    Surroundings& here = all[static_cast<std::size_t>(i)];
    here.breaks.clear();
    for (const Neighbour& neighbour : neighbours[static_cast<std::size_t>(i)]) {
      // Two strokes on one edge, or a line that has taken another's edge: neither leaves anything to the other.
      if (stage != Stage::kFirst && std::abs(neighbour.offset) < kSameEdge) continue;
      if (stage != Stage::kFirst && own_strong) {
        leaveTo(neighbour.offset, neighbour.offset < 0.0, true, here.range);
        continue;
      }
      double side = neighbour.offset;
      if (stage != Stage::kFirst) {
        // A weak line that begins again at the hand may lie across a strong one that has been located.
        side = sideOf(line, neighbours, i, neighbour);
        const bool known = strong[static_cast<std::size_t>(neighbour.line)];
        if (known || stage == Stage::kRefine) {
          leaveTo(neighbour.offset, side < 0.0, !known, here.range);
          continue;
        }
      }
      here.breaks.push_back(std::copysign(std::max(kLeastApart, std::abs(neighbour.offset)), side));
    }
    here.breaks.push_back(0.0);
    std::sort(here.breaks.begin(), here.breaks.end());
    here.own = static_cast<std::size_t>(std::lower_bound(here.breaks.begin(), here.breaks.end(), 0.0) -
                                        here.breaks.begin());
  }
  return all;
}

}  // namespace fettle::engine
