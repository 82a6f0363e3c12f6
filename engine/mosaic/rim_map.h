#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// How far places of a field are from its rim: its border, and holes larger than a block of samples (at most 256 x 256
/// blocks). From that the weights with which overlapping scans fade into each other. Threading: const functions from any
/// thread.
class RimMap {
 public:
  /// Errors: kCancelled. Throws std::bad_alloc. Thread: any; a long job on all workers of the calling arena.
  [[nodiscard]] static Result<RimMap> create(const Version& field, JobControl& job);

  /// Distance of a place in field coordinates to the rim [mm], to about a block, continuous; at least a millionth of a block.
  [[nodiscard]] double at(double x, double y) const noexcept;

 private:
  std::int32_t width_ = 0, height_ = 0;
  double x0_ = 0.0, y0_ = 0.0, block_x_ = 1.0, block_y_ = 1.0;  // middle of the first block, sides [mm]
  double right_ = 0.0, upper_ = 0.0;                            // the field's border [mm]
  std::vector<double> distance_;                                // of the blocks' middles [mm]
};

}  // namespace fettle::engine
