#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/measure/surface.h"

namespace fettle::engine {

/// A hill: a peak and what flows up to it.
struct Hill {
  std::int32_t column = 0, row = 0;  ///< of its peak in the surface
  double peak = 0.0;                 ///< [height_unit]
  /// Over the highest saddle to a higher hill; of the highest hill of connected samples over the lowest of these
  /// [height_unit].
  double height = 0.0;
};

/// Hills, and which of them each sample belongs to: that to which it rises along the steepest way over its neighbours along rows and columns, and of a
/// hill that was pruned that on the other side of its saddle.
struct HillMap {
  std::vector<Hill> hills;  ///< in the order of their peaks, the highest first
  /// Of each sample of the surface, row-major, the number of its hill in `hills`; kNone of holes and of parts without a hill.
  std::vector<std::int32_t> of;

  static constexpr std::int32_t kNone = -1;
};

/// The hills of a surface by watershed segmentation with Wolf's pruning (ISO 16610-85:2013; ISO 25178-2:2021; G. Wolf,
/// Scale independent surface characterisation: geography meets precision surface metrology, 2017): while a hill is lower
/// than `least` [height_unit] over its saddle, the lowest of these becomes part of the hill on the saddle's other side.
/// The surface is the bilinear one: samples are neighbours along rows and columns, and across a cell where its patch has a
/// saddle, at the saddle's height. Its border and holes are the lowest of all. Of equal heights the first sample counts
/// as the higher one.
///
/// By decreasing height, as R. Tarjan's sets merge (Efficiency of a good but not linear set union algorithm, 1975).
/// Memory: some 40 bytes per sample. Surfaces of at most kMostMapped samples. Bit-identical for any
/// number of threads. Errors: kCancelled. Throws std::bad_alloc. Thread: any; sorting on all workers of the arena.
[[nodiscard]] Result<HillMap> mapHills(const Surface& surface, double least, JobControl& job);
inline constexpr std::size_t kMostMapped = std::numeric_limits<std::uint32_t>::max() - 1;

/// What a segment is like.
struct HillFigures {
  Hill hill;
  double saddle =
      0.0;  ///< height of the highest saddle to another hill; without one as of `hill.height` [height_unit]
  std::int64_t samples = 0;
  double area_mm2 = 0.0;        ///< of its samples
  double area_above_mm2 = 0.0;  ///< of those above its saddle
  double volume_mm3 = 0.0;      ///< between these and the saddle's height
  bool open = false;            ///< above its saddle it reaches the border of the surface, or a hole
  bool cut = false;             ///< it reaches the border, or a hole: part of its area may lie beyond
};
/// Of each hill of a map, in its order.
[[nodiscard]] std::vector<HillFigures> figuresOfHills(const Surface& surface, const HillMap& map);

}  // namespace fettle::engine
