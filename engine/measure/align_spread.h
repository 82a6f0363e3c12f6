#pragma once

#include <vector>

#include "engine/measure/align_level.h"

namespace fettle::engine {

/// The size of a residual that a share of all does not exceed [mm]; 0 without any. Throws std::bad_alloc.
[[nodiscard]] double residualAt(const std::vector<AlignLevel::Under>& under, double share);

/// The size of residuals by slope: on level parts `level`; on steep ones of `sideways` mm across as well, where edges differ
/// or do not lie on each other yet. By one size for all, the few heights of edges, which alone decide a shift of a part
/// of level faces, would count as outliers.
struct AlignSpread {
  double level = 0.0, sideways = 0.0;  ///< [mm]

  /// Of the residual at a place [mm].
  [[nodiscard]] double at(const AlignLevel::Under& u) const noexcept;
};

/// Normalised median sizes: `level` of all residuals, no less than `least`; `sideways` so that at() is that of the residuals
/// in the class of slopes where they are largest, no more than `spacing`, and 0 where no class of 24 places or more has some
/// larger than half again as `level`. Throws std::bad_alloc.
[[nodiscard]] AlignSpread spreadOf(const std::vector<AlignLevel::Under>& under, double spacing, double least);

}  // namespace fettle::engine
