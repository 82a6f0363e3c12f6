#pragma once

#include <cstdint>
#include <functional>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/row_span.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"

namespace fettle::engine {

/// What a filter did to the rows of a band, against its input. Of all bands of a field together FilterReport follows: `squares`
/// is a sum in double row by row, so that the root of its mean is the whole run's to some 1e-12 of itself and not to
/// the last bit; the other figures are.
struct BandReport {
  std::int64_t samples = 0;  ///< that are not holes
  std::int64_t holes = 0;
  std::int64_t changed = 0;
  double max_change = 0.0;  ///< [height_unit]
  double squares = 0.0;     ///< of changes, summed [height_unit^2]
  std::uint64_t hash = 0;   ///< contentHash of the rows as a field, without marks
};

/// Takes rows as they are finished, from the first of the band on: row, how many, width heights for each [height_unit].
using TakeRows = std::function<Status(std::int32_t row, std::int32_t rows, const float* heights)>;

/// Applies a filter to rows of a field, and passes those of `own`, rows of the whole field, to `take`: the bits that applyFilter of
/// the whole field gives them. `input` holds the rows `read` (rowsRead), `original` the same rows of what
/// FilterSpec::max_change is measured against. `spec` has its range; null: the rows as they are.
/// Errors, progress, threads as applyFilter, and those of `take`.
[[nodiscard]] Result<BandReport> filterBand(const Version& input, const Version& original,
                                            const FilterSpec* spec, const RowSpan& read, const RowSpan& own,
                                            const TakeRows& take, JobControl& job);

}  // namespace fettle::engine
