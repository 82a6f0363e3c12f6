#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"
#include "engine/filter/filter_work.h"

namespace fettle::engine {

/// What a filter of a whole field will take, from some of its blocks worked out on this machine.
struct WorkSample {
  double seconds = 0.0;             ///< of all passes, without what writing the result takes
  double changed_share = 1.0;       ///< of the field's tiles, 0 .. 1
  std::uint64_t scratch_bytes = 0;  ///< memory that the workers take beside tiles
  TileRect block{};                 ///< one that was worked out
  Version worked;                   ///< the field with those blocks after one pass
};

struct SampleOptions {
  double seconds = 0.5;  ///< most time of the sample, about; never less than a block for each thread
  /// No sample is taken where one block for each thread is more than this share of the work.
  double most_share = 1.0 / 32.0;
  bool on_device = false;  ///< `apply` runs on another processor: time is then that of the whole sample
};

/// applyFilter of one field, or the same on a device, with FilterTuning::work.
using ApplyFilter =
    std::function<Result<Filtered>(const FilterSpec& spec, FilterWork& work, JobControl& job)>;

/// Blocks at seeded random places, as applyFilter cuts the field for spec.threads, more of them in each round until the
/// time is used. Of several passes the first is measured. How far it is off: `fettle bench estimate`. Nothing where the field is too small for a sample, or the filter takes none (Filter::sampled).
/// Errors as applyFilter. Not while another job measures memory (resetPeak).
[[nodiscard]] Result<std::optional<WorkSample>> sampleWork(const FilterSpec& spec, const ApplyFilter& apply,
                                                           const SampleOptions& options, JobControl& job);

}  // namespace fettle::engine
