#pragma once

#include <cmath>

namespace fettle::engine {

/// The weights of the robust filters end at so many medians of the distances: three standard deviations of normal ones are
/// 4.4478 medians, 3 / 0.6745.
inline constexpr double kRobustLimit = 4.4478;
/// Their rounds end where the limit changes by less than this share of itself, and after so many.
inline constexpr double kRobustTolerance = 1e-4;
inline constexpr int kMostRobustRounds = 50;

/// What the filter without weights takes from the surface itself at a place shows how far a surface like it lies from the filter's
/// result there without any outlier. A sample on that side of the surface may be so many times as much farther away.
///
/// Without this, where noise is small beside the waviness, ends and crests are taken for outliers: their distances are several
/// times the median, as the filter is off by a third derivative at an end and by a fourth one inside. A sample that has lost its
/// weight holds the surface no more, and the next ones lose theirs. With 1 some waves of the tests are still lost, from 1.5 on none without spikes, and least with them at 2;
/// with 4 the surface follows grooves a third of the cut-off wide (docs/decisions/standard-filters.md).
inline constexpr double kRobustBend = 2.0;

/// Tukey's biweight of a sample `off` from a surface (its height less the surface's) from which the filter without weights takes `bend`
/// there; 0 from the limit on, which is above 0.
[[nodiscard]] inline double robustWeight(double off, double bend, double limit) noexcept {
  double distance = std::fabs(off);
  if (off * bend > 0.0) distance = std::fmax(distance - kRobustBend * std::fabs(bend), 0.0);
  const double share = distance / limit, rest = 1.0 - share * share;
  return rest > 0.0 ? rest * rest : 0.0;
}

}  // namespace fettle::engine
