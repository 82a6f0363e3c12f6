#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"

namespace fettle::engine {

// Which filter to take for a scan, found by trying: pieces of the scan are made into stand-ins (stand_in.h),
// scans of the same shape and noise whose truth is known, and every candidate is run on them and timed.
//
//   scan --16 pieces, where it is steepest--> stand-ins --each candidate--> error on flats, near edges, time
//                                                                     \--> the fastest within the tolerance

struct SuggestionRequest {
  /// The root mean square error against the true surface that may be left [height_unit, > 0], on flats
  /// (further than 12 samples from every edge) and near edges (within 3 samples) each by itself.
  double tolerance = 0.0;
  std::optional<double> budget_s;  ///< that the whole scan may take [s, > 0]; none = any
  int threads = 0;                 ///< as FilterSpec::threads
};

/// One way to filter the scan and what it is expected to leave.
struct FilterCandidate {
  FilterSpec spec;  ///< window 1: the scan as it is
  /// Whether edges are found and marked first, `thickness` samples to both sides: as far as the filter
  /// reaches.
  bool around_edges = false;
  double thickness = 0.0;
  double error_flat = 0.0;  ///< root mean square [height_unit]; NaN: no flats there
  double error_edge = 0.0;  ///< likewise; NaN: no edges there
  double seconds = 0.0;     ///< for the whole scan, finding edges included, from this machine's rate just now
  bool within = false;      ///< both errors within the tolerance and the time within the budget

  /// The larger of the two errors there are.
  [[nodiscard]] double error() const noexcept;
};

struct FilterSuggestion {
  double sigma = 0.0;                       ///< the scan's noise (estimateNoise) [height_unit]
  std::int64_t samples = 0;                 ///< that were tried on, holes left out
  double outlier_share = 0.0;               ///< of them
  double edge_share = 0.0;                  ///< of them near edges; pieces are taken where it is steepest
  std::vector<FilterCandidate> candidates;  ///< the scan as it is first
  /// The fastest within tolerance and budget; without any, the one of least error() within the budget.
  std::size_t pick = 0;
  [[nodiscard]] const FilterCandidate& picked() const noexcept { return candidates[pick]; }
  [[nodiscard]] bool met() const noexcept { return picked().within; }
};

/// Tries filters for a scan. The error that filters which keep edges are expected to leave is 0.71 to 1.8
/// times the true one on the simulated scans of the tests: too large rather where the filter is strong,
/// because what the stand-ins kept of the noise counts as surface. Noise that neighbours share is not seen
/// (estimateNoise) and stays, whatever is expected. Marks of the field are kept by every candidate. Takes
/// some three seconds on two cores whatever the scan's size. Errors are the same each time; times are
/// measured, so that two filters of much the same speed may change places from run to run.
///
/// Progress: a stage of its own; a cancel is seen within a fraction of a second. Errors: tolerance or budget
/// not positive and finite, no noise to be seen (kInput); cancelled; memory (kFailed). Any thread, on all
/// workers.
[[nodiscard]] Result<FilterSuggestion> suggestFilter(const Version& field, const SuggestionRequest& request,
                                                     JobControl& job);

}  // namespace fettle::engine
