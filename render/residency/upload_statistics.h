#pragma once

#include <cstdint>

namespace fettle::render {

/// Cost of uploading a version.
struct UploadStatistics {
  std::int64_t tiles = 0;            ///< uploaded tiles of heights and tiles of marks
  std::int64_t bytes = 0;            ///< all uploaded bytes, coarse copies included
  std::int64_t changed_samples = 0;  ///< in the rectangles that differ, one per tile
  std::int64_t pending_tiles = 0;  ///< left for the next frames, unmeasured tiles and waiting pages included
  std::int64_t pending_of_first =
      0;  ///< tiles of the first version alone, whose samples on the device are older
  std::int64_t measured_tiles =
      0;  ///< whose detail was measured (again), at most kMeasuredPerFrame per panel
  std::int64_t unmeasured_tiles =
      0;                    ///< whose detail is not known yet: drawn finer than necessary, bound_px holds
  std::int64_t stalls = 0;  ///< times the CPU waited for staging to be free
  double ms = 0.0;          ///< on this thread: comparing, measuring, copying to staging
};

}  // namespace fettle::render
