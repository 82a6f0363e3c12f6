#pragma once

#include <cstdint>
#include <string>
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

/// The hills of a surface by watershed segmentation with Wolf's pruning (ISO 16610-85:2013; ISO 25178-2:2021; G. Wolf,
/// Scale independent surface characterisation: geography meets precision surface metrology, 2017): while a hill is lower
/// than `least` [height_unit] over its saddle, the lowest of these becomes part of the hill on the saddle's other side.
/// The surface is the bilinear one: samples are neighbours along rows and columns, and across a cell where its patch has a
/// saddle, at the saddle's height. Its border and holes are the lowest of all. Of equal heights the first sample counts
/// as the higher one.
///
/// By decreasing height, as R. Tarjan's sets merge (Efficiency of a good but not linear set union algorithm, 1975).
/// Memory: some 28 bytes per sample. The hills are in the order of their peaks, the highest first; bit-identical for any
/// number of threads. Errors: kCancelled. Throws std::bad_alloc. Thread: any; sorting on all workers of the arena.
[[nodiscard]] Result<std::vector<Hill>> segmentHills(const Surface& surface, double least, JobControl& job);

/// Hills, and which of them each sample belongs to: that to which it rises along the steepest way over its neighbours along rows and columns, and of a
/// hill that was pruned that on the other side of its saddle.
struct HillMap {
  std::vector<Hill> hills;  ///< as segmentHills()
  /// Of each sample of the surface, row-major, the number of its hill in `hills`; kNone of holes and of parts without a hill.
  std::vector<std::int32_t> of;

  static constexpr std::int32_t kNone = -1;
};
/// The segmentation itself. Memory: 12 bytes per sample beside that of segmentHills(). Surfaces of at most 2^31 - 1 samples. Errors and the rest: as
/// segmentHills.
[[nodiscard]] Result<HillMap> mapHills(const Surface& surface, double least, JobControl& job);

/// What a segment is like.
struct HillFigures {
  Hill hill;
  std::int64_t samples = 0;
  double area_mm2 = 0.0;        ///< of its samples
  double area_above_mm2 = 0.0;  ///< of those above its saddle
  double volume_mm3 = 0.0;      ///< between these and the saddle's height
  bool open = false;            ///< it reaches the border of the surface, or a hole, above its saddle
};
/// Of each hill of a map, in its order.
[[nodiscard]] std::vector<HillFigures> figuresOfHills(const Surface& surface, const HillMap& map);

/// Feature parameters: ISO 25178-2:2021.
struct FeatureParameters {
  std::int64_t hills = 0;
  double spd = 0.0;            ///< density of peaks [1/mm^2]
  double spc = 0.0;            ///< arithmetic mean peak curvature [1/mm]
  std::int64_t curved = 0;     ///< peaks of spc: those with four neighbours
  std::string no_spd, no_spc;  ///< why a figure is NaN; empty where it is none
};

/// Spd and Spc of the hills that are at least a share of `sz` high, 0.05 as the standard presumes. An area is that of
/// a sample for each sample; curvature by second differences at the peak. Errors and the rest: as segmentHills.
[[nodiscard]] Result<FeatureParameters> measureFeatures(const Surface& surface, double sz, double prune,
                                                        JobControl& job);

}  // namespace fettle::engine
