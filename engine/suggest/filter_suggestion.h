#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"

namespace fettle::engine {

// Suggests a filter for a scan by trying: pieces of the scan (mosaic.h) are turned into a synthetic sample
// (synthetic_sample.h), a scan of the same shape and noise whose truth is known, and every candidate is run on
// it and timed.
//
//   scan --pieces--> mosaic --> sample --each candidate--> error on flats, near edges, time
//                                                        \--> the cheapest within the tolerance

struct SuggestionRequest {
  /// Largest root mean square error against the true surface [height_unit, > 0], on flats (farther than 12
  /// samples from every edge) and near edges (within 3 samples) separately.
  double tolerance = 0.0;
  std::optional<double> budget_s;  ///< that the whole scan may take [s, > 0]; none = any
  int threads = 0;                 ///< as FilterSpec::threads
  /// Leaves candidates untried that cost more than one that is within tolerance and budget: their errors are NaN. A third of
  /// the time.
  bool only_named = false;
};

/// Samples of a scan from which on a suggestion takes no longer.
inline constexpr double kMostSuggestionSamples = 1248.0 * 1248.0;

/// One filter for the scan and its expected error.
struct FilterCandidate {
  FilterSpec spec;  ///< window 1: the scan unfiltered
  double noises =
      0.0;  ///< FilterSpec::range_sigma in standard deviations of the noise; 0: the filter has none
  /// Whether edges are found and marked first, `thickness` samples to both sides: as far as the filter
  /// reaches.
  bool around_edges = false;
  double thickness = 0.0;
  double error_flat = 0.0;  ///< root mean square [height_unit]; NaN: no flats there
  double error_edge = 0.0;  ///< likewise; NaN: no edges there
  double seconds = 0.0;     ///< for the whole scan, finding edges included, from this machine's measured rate
  double cost = 0.0;        ///< known beforehand (FilterTrial::cost), finding edges included [ns per sample]
  bool within = false;      ///< both errors within the tolerance and the time within the budget

  /// The larger of the two errors.
  [[nodiscard]] double error() const noexcept;
  /// Whether it is named instead of `other`, which is good enough as well and stands before it in the table: it costs less,
  /// or as much and is expected to leave less by more than a tenth, which is how certain expectations are. Else the one
  /// before stays, of two ranges of a filter the smaller, which changes the scan less. By no clock, so that the same scan
  /// gives the same answer on a busy machine.
  [[nodiscard]] bool betterThan(const FilterCandidate& other) const noexcept;
};

/// The candidate in words, another for each that is tried: "tv 31, range 1.5 noises". The range that the filter takes by
/// itself is not named.
[[nodiscard]] std::string methodOf(const FilterCandidate& candidate);
/// What of that FilterSpec does not say: ", range 1.5 noises", " around suggested edges"; may be empty.
[[nodiscard]] std::string detailsOf(const FilterCandidate& candidate);

struct FilterSuggestion {
  double sigma = 0.0;                       ///< the scan's noise (measureNoise) [height_unit]
  double rows = 0.0, columns = 0.0;         ///< of that, what whole rows and columns are off [height_unit]
  std::int64_t samples = 0;                 ///< used for the trials, holes left out
  double outlier_share = 0.0;               ///< of them
  double edge_share = 0.0;                  ///< of those judged, near edges
  std::vector<FilterCandidate> candidates;  ///< the unfiltered scan first
  /// The cheapest (betterThan) within tolerance and budget; without any, the one of least error() within the budget.
  std::size_t pick = 0;
  [[nodiscard]] const FilterCandidate& picked() const noexcept { return candidates[pick]; }
  [[nodiscard]] bool met() const noexcept { return picked().within; }
};

/// Tries filters for a scan. On simulated scans of 1024 x 1024 samples the expected errors are within 10 % of the true ones
/// for nine of ten of all figures (docs/decisions/suggested-filters.md has them by part), and not where the smoothing
/// that makes the truth loses what the scan has: near steps of the noise's own size generalised variation leaves 1.3
/// times what is expected. Marks of the field are kept by every candidate; edge lines of the field are not used. Takes
/// some 11 s of processor time for any size of scan from 1248 x 1248 samples on, on all cores. Errors, and without a budget the
/// one that is named, are the same each time; times are measured.
///
/// Progress: one stage; a cancel takes effect after the candidate at work, two seconds at most on two cores. Errors:
/// tolerance or budget not positive and finite, no noise found (kInput); cancelled; memory (kFailed). Any thread, on all
/// workers.
[[nodiscard]] Result<FilterSuggestion> suggestFilter(const Version& field, const SuggestionRequest& request,
                                                     JobControl& job);

}  // namespace fettle::engine
