#pragma once

#include <cstdint>

namespace fettle::render {

/// What bringing a version over took.
struct UploadStatistics {
  std::int64_t tiles = 0;            ///< tiles of heights and tiles of marks that moved
  std::int64_t bytes = 0;            ///< all that moved, coarse copies included
  std::int64_t changed_samples = 0;  ///< in the rectangles that differ, one a tile
  std::int64_t pending_tiles =
      0;  ///< left for the next frames, unmeasured tiles and pages that wait included
  std::int64_t measured_tiles = 0;  ///< whose detail was measured (anew), at most kMeasuredAFrame a panel
  std::int64_t unmeasured_tiles =
      0;                    ///< whose detail is not known yet: drawn finer than need be, bound_px holds
  std::int64_t stalls = 0;  ///< times the CPU waited for staging to be free
  double ms = 0.0;          ///< on this thread: comparing, measuring, copying to staging
};

}  // namespace fettle::render
