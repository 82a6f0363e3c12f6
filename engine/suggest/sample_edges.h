#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// The edges of a synthetic sample (synthetic_sample.h): `surface` with the samples marked that lie on them. `scan` is
/// what the surface was made of, `sigma` its noise [height_unit, > 0], `faint` the surface with less noise.
///
/// Searched in the scan first, as findEdges usually does and, farther than 4 samples from what that finds, with twice its
/// sigma. Curves are creases to the filter that makes the surface, so that only jumps of the surface between samples next
/// to each other, larger than the slopes beyond them, are taken from it: of more than 6 sigma all, since the search's
/// median removes ribs of one or two samples; of more than 2.5 sigma those that are edges in `faint`. Errors: cancelled;
/// memory (kFailed). Throws std::bad_alloc.
[[nodiscard]] Result<Version> markSampleEdges(const Version& scan, const Version& surface,
                                              const Version& faint, double sigma, JobControl& job);

}  // namespace fettle::engine
