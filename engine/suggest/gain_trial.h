#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// What lines gain at each sample of a piece, by two estimates that fail in different ways.
struct GainTrial {
  // [height_unit^2], columns x rows of the piece, row-major; 0 at holes.
  std::vector<double> change;  ///< squared difference of the results with and without the lines
  std::vector<double> gain;    ///< squared error without the lines less that with them, on a synthetic scan
  std::vector<double> left;    ///< squared error without the lines, on the same
};

/// Tries generalised variation with the lines of `piece` and with `lines` in their place, on the piece itself and where the truth is known:
///
///   piece --tgv without, with lines--> their difference; the latter is taken for the surface
///   surface --white noise, outliers in--> scan --tgv without, with lines--> both errors
///
/// so that the surface has the piece's own edges at their own heights, and the filter's own mistakes are counted
/// rather than guessed (a parametric bootstrap: B. Efron, Bootstrap methods, 1979). An outlier is a sample more than
/// 6 sigma off the surface: it keeps its height; marks stay. The noise of sample (c, r) is that of (column + c, row + r), so that pieces that overlap agree on it.
/// `sigma`: standard deviation [height_unit, > 0]. `threads`: as FilterSpec::threads. Bit-identical for the same
/// arguments. A cancel is seen between the four runs of the filter. Errors: as applyFilter(). Throws std::bad_alloc.
[[nodiscard]] Result<GainTrial> tryLines(const Version& piece, const EdgeLines& lines, double sigma,
                                         std::int32_t column, std::int32_t row, int threads,
                                         const JobControl& job);

}  // namespace fettle::engine
