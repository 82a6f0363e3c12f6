#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// The deviation of b from a as a new field: at each sample b - a, in the height unit of a (b is converted
/// when its unit differs), computed in double and rounded once to float; a hole where either is one. Signs of
/// the versions are applied. On the grid of a - position, spacing, units, coordinate system - but without its
/// height_per_count: differences are not counts of the source. No marks.
/// Errors: sizes differ (kInput), memory exhausted, cancelled. Thread: any, on all workers of the calling
/// arena; bit-identical for any number of them.
[[nodiscard]] Result<Version> deviationField(const Version& a, const Version& b, JobControl& job);

}  // namespace fettle::engine
