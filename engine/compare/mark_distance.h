#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "engine/field/reader.h"
#include "engine/field/sample_rect.h"

namespace fettle::engine {

/// Squared distances [samples^2] of a tile's samples to the nearest mark of a field, exact up to a reach, beyond that
/// kFar. Rows first, then columns (Felzenszwalb and Huttenlocher, Distance transforms of sampled functions, 2012: the
/// squared Euclidean distance is separable). One object serves one thread; it keeps its buffers.
class MarkDistance {
 public:
  static constexpr int kFar = std::numeric_limits<int>::max();

  /// `reach` in samples, 0 .. 64.
  explicit MarkDistance(int reach) : reach_(reach) {}

  /// Of the samples of `rect`, at most kTileSide x kTileSide; row-major, stride kTileSide. Valid until the next call.
  /// Throws std::bad_alloc.
  const std::vector<int>& measure(const FieldReader& marks, const SampleRect& rect);

 private:
  int reach_;
  std::vector<std::uint8_t> marks_;
  std::vector<int> along_;
  std::vector<int> squared_;
};

}  // namespace fettle::engine
