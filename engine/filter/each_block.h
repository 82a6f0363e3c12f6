#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/filter/block_pass.h"
#include "engine/filter/filter_work.h"
#include "engine/filter/pass.h"

namespace fettle::engine {

/// How a field is cut into blocks [tiles].
struct BlockCut {
  std::int32_t columns, rows;
};

/// Works the tiles of a block out and appends those that changed. False when cancelled or out of memory. Called from any
/// thread, for several blocks at once.
using RunBlock = std::function<bool(const TileRect& block, std::vector<NewTile>& made)>;

/// All blocks of a field, but those that `work` (which may be null) has already, on the calling arena: row by row, or in
/// the order that `work` wishes, which may change meanwhile. Then the pass's result. Advances the progress by the field's
/// samples. Errors: cancelled, out of memory.
[[nodiscard]] Result<PassResult> passOverBlocks(const BlockPass& blocks, const BlockCut& cut,
                                                FilterWork* work, const RunBlock& run, JobControl& job);

}  // namespace fettle::engine
