#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"
#include "engine/filter/merge.h"
#include "engine/simd/cpu.h"

namespace fettle::engine {

class FilterWork;

/// What decides how the work is cut up, and never what comes out.
struct FilterTuning {
  /// Side of the blocks [samples], a multiple of kTileSide; 0 = what suits the filter and its window.
  int block_side = 0;
  /// Kernels of no higher level are used.
  CpuLevel level = CpuLevel::kAvx512;
  /// Goes along with the work (filter_work.h); outlives it. Null: none.
  FilterWork* work = nullptr;
};

/// applyFilter with the work cut up so: for tests that the cut does not show, for benchmarks, and for work that is kept.
[[nodiscard]] Result<Filtered> applyFilter(const Version& input, const Version& original,
                                           const FilterSpec& spec, const FilterTuning& tuning,
                                           JobControl& job);

/// The field after one pass, and what happened to each tile that changed, in the order of changedTiles.
struct PassResult {
  Version field;
  std::vector<TileReport> reports;
  std::int64_t weightless = 0;  ///< of a robust filter, the samples without weight in its last round
};

}  // namespace fettle::engine
