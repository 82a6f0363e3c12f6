#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "engine/io/points/gridding.h"

namespace fettle::engine {

/// The raster of a range scanner: for each of its places, row by row, the point that was measured there.
struct RangeGrid {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::uint64_t columns = 0, rows = 0;
  std::vector<std::uint32_t> points;  ///< columns * rows numbers of points, kNone where none was measured
};

/// Makes a field of a range scan: samples are the scanner's places, heights the points' z, bit-identical;
/// rows are ordered so that y rises, columns so that x does. Spacing and origin are those of the line that
/// fits the points' positions best, or the camera's where the points are those of a camera (perspective.h); a
/// warning states the deviation of the points. With ImportOptions::cell_size or spacing: gridPoints. `cloud`
/// is organised (PointCloud::organized). Errors (kInput): a number past the points, a grid past memory, no
/// point at all.
[[nodiscard]] Result<Imported> gridRange(PointCloud&& cloud, const RangeGrid& grid,
                                         const ImportOptions& options, std::string format,
                                         const std::string& path, JobControl& job);

}  // namespace fettle::engine
