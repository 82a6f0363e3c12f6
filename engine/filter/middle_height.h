#pragma once

#include <vector>

#include "engine/filter/block.h"

namespace fettle::engine {

/// The median of a block's heights, of an even count the mean of both middle ones, so that what is upside down has the
/// same; 0 without any. Of every `step`-th column and row, or of all where these have only holes. A reference that leaves
/// the digits of floats and of sums to the noise. [height_unit]
[[nodiscard]] double middleHeight(const Block& block, std::vector<float>& scratch, int step = 1);

}  // namespace fettle::engine
