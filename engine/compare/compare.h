#pragma once

#include <cstdint>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// A figure without any sample: NaN here, "-" in a table, null in JSON.
inline constexpr double kNoFigure = std::numeric_limits<double>::quiet_NaN();

/// How far field b is from field a: d = b - a at every sample that is valid in both, and the roughness of
/// each. All lengths in the height unit of a (b is converted when its unit differs). NaN where there is no
/// sample.
struct Deviation {
  std::int64_t samples = 0;  ///< valid in both
  std::int64_t only_a = 0;   ///< valid in a, a hole in b
  std::int64_t only_b = 0;   ///< a hole in a, valid in b
  double rms = 0.0;          ///< sqrt(mean(d^2)): the mean is not subtracted
  double mean = 0.0;         ///< mean(d)
  double max_abs = 0.0;      ///< max |d|
  double p99 = 0.0;  ///< smallest v with |d| <= v for at least 99 % of the samples (nearest rank), exact
  /// ISO 25178-2:2012, 4.1.1 and 4.1.7: root mean square height Sq and arithmetical mean height Sa, about the
  /// least-squares plane (F-operator: levelling; no S- or L-filter), over all valid samples of the one field.
  double sq_a = 0.0;
  double sa_a = 0.0;
  double sq_b = 0.0;
  double sa_b = 0.0;
};

/// Deviation of b from a. Signs of the versions are applied. Exactness: differences in double, means in two
/// compensated passes (relative error below 1e-14 of the largest height), p99 by exact selection.
/// Threading: tiles on all workers of the calling arena; bit-identical for any thread count. Errors: sizes
/// differ (kInput), cancelled.
[[nodiscard]] Result<Deviation> compareFields(const Version& a, const Version& b, JobControl& job);

/// Where "near an edge" ends and "flat" begins, and how edge width is measured. Distances in samples, centre
/// to centre.
struct TruthOptions {
  double near_edge = 3.0;  ///< nearer than or at this distance of a marked sample = near edges; 0 .. 64
  double flat = 12.0;      ///< farther than this from every marked sample = flats; near_edge .. 64
  /// Profiles across a step reach this far to both sides [samples], 4 .. 64: no wider than the distance to
  /// the next edge, no narrower than the blur to be measured.
  int profile_reach = 12;
  /// A profile averages the samples this far along the edge to both sides [samples], 2 .. 64.
  int profile_half_length = 8;
};

/// How far a field is from the truth. Lengths in the height unit of the truth, except edge_width.
struct TruthFigures {
  std::int64_t samples = 0;       ///< valid in both
  std::int64_t flat_samples = 0;  ///< of these, flats
  std::int64_t edge_samples = 0;  ///< of these, near edges
  std::int64_t lost = 0;          ///< valid in the truth, a hole in the field
  double rmse = 0.0;              ///< over all samples; NaN without any, likewise below
  double rmse_flat = 0.0;
  double rmse_edge = 0.0;
  double max_abs_edge = 0.0;  ///< largest error near edges
  /// Median over all profiles of the distance [mm] in which the field rises from 10 to 90 % of the true step
  /// across true step edges; NaN when no profile could be measured. An ideal step has 0.8 samples at most:
  /// the sampling's own limit.
  double edge_width = 0.0;
  double edge_width_truth = 0.0;   ///< the same for the truth itself over the same profiles: the lower limit
  std::int64_t edge_profiles = 0;  ///< profiles measured
  std::int64_t unresolved_profiles =
      0;  ///< usable in the truth, but the field never spans 10 to 90 % in reach
};

/// Deviation of a field from the truth, overall, on flats and near edges, and the width of its edges. Only
/// the marks of `edges` are used (heights not read): the samples where the truth has an edge, step or crease;
/// the profiles determine which are steps, and leave out corners, ribs, places with another edge in reach and
/// where the field has too many holes. See edge_width.h for the method. Threading and determinism as
/// compareFields. Errors: sizes differ or options out of range (kInput), cancelled.
[[nodiscard]] Result<TruthFigures> compareToTruth(const Version& field, const Version& truth,
                                                  const Version& edges, JobControl& job,
                                                  const TruthOptions& options = {});

/// The deviation of b from a as a new field: at each sample b - a, in the height unit of a (b is converted
/// when its unit differs), computed in double and rounded once to float; a hole where either is one. Signs of
/// the versions are applied. On the grid of a - position, spacing, units, coordinate system - but without its
/// height_per_count: differences are not counts of the source. No marks.
/// Errors: sizes differ (kInput), memory exhausted, cancelled. Thread: any, on all workers of the calling
/// arena; bit-identical for any number of them.
[[nodiscard]] Result<Version> deviationField(const Version& a, const Version& b, JobControl& job);

}  // namespace fettle::engine
