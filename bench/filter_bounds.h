#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"

namespace fettle::bench {

/// What a filter of one thread cannot do without, measured alone, beside the filter in the same run. Seconds per sample of processor
/// time, medians of the repeats.
struct FilterBound {
  double filter = 0.0;  ///< all of applyFilter
  double tiles =
      0.0;  ///< every tile read, and a new one written with its marks, bounds and report: results lie ready
  double operations =
      0.0;  ///< fused products or minima and maxima, in registers; 0: not counted for this filter
};

/// Products per sample of a Gaussian's two passes, or minima and maxima of a median's shared networks; 0: not counted.
[[nodiscard]] double operationsOf(const engine::FilterSpec& spec);

/// Of a spec with one thread. Error kFailed: out of memory. Thread: any; blocks.
[[nodiscard]] engine::Result<FilterBound> filterBound(const engine::Version& field,
                                                      const engine::FilterSpec& spec, int repeats,
                                                      engine::JobControl& job);

}  // namespace fettle::bench
