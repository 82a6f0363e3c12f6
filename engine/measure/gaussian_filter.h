#pragma once

#include <cstdint>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// What of a surface a filter leaves.
enum class Waves : std::uint8_t {
  kLong,   ///< those longer than the cut-off: an S-filter removes noise and small detail
  kShort,  ///< the others: an L-filter removes waviness
};

/// Shortest cut-off, in the larger spacing of a field: a wave of two samples is the shortest that there is.
inline constexpr double kLeastCutOff = 2.0;

/// The linear areal Gaussian filter of ISO 16610-61:2015 with a cut-off (nesting index) in millimetres: weights
/// exp(-pi (x^2 + y^2) / (a L)^2), a = sqrt(ln 2 / pi), of which a wave of length L keeps half of its amplitude in any
/// direction. In millimetres, so that unequal spacings have unequal numbers of samples. Weights reach to L, where
/// those beyond are 1e-7 of all (-61 asks for L / 2 at least, which leaves out 0.8 %).
///
/// At the border and at holes the weights of the samples that there are sum up to 1, as ISO 16610-28 has it for a moment
/// criterion of order 0, about the least-squares plane of all samples, so that a tilted surface keeps its ends. Holes,
/// marks, edge lines and the field's place stay. Marked samples are filtered as others: marks choose what is measured.
/// Edge lines are no walls.
///
/// By transforms, in double: error 1e-13 of the largest height about that plane, and one rounding to float. Bit-identical for
/// any number of threads. Memory: 16 bytes per sample of the field and of the weights' reach around it. Errors: kInput for
/// a cut-off below kLeastCutOff spacings; kFailed without memory; kCancelled. Thread: any; a long job on all workers of the
/// calling arena.
[[nodiscard]] Result<Version> gaussianFiltered(const Version& field, double cut_off_mm, Waves waves,
                                               JobControl& job);

}  // namespace fettle::engine
