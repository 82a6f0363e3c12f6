#pragma once

#include <cstdint>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/grid.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// How heights between samples come about. All are separable along the rows and columns of the field; where the new samples
/// are farther apart than the old ones by a factor s, the kernel is s times as wide, so that what is finer than the new
/// spacing is averaged and not folded into longer waves.
enum class Resampling : std::uint8_t {
  kArea,    ///< mean over s x s old samples, each counting with the part of its cell that is covered
  kLinear,  ///< triangle of half width s: between samples the bilinear patch
  kCubic,  ///< cubic convolution, a = -1/2, half width 2 s (Keys 1981): exact for polynomials of degree 2 at s = 1
};

struct ResampleOptions {
  Resampling method = Resampling::kCubic;
  double angle_deg = 0.0;  ///< counter-clockwise, seen from above, about the field's middle; finite
  double spacing_x = 0.0;  ///< new [lateral unit], > 0; of the turned field's axes
  double spacing_y = 0.0;

  static constexpr double kMostCoarser = 256.0;  ///< times the old spacing
};

/// The field at new places.
///
/// Without an angle the first sample stays (linear, cubic), and the last is the last that fits in; of an area the lower
/// left corner of the first cell stays, and cells are those that fit in. With an angle the field is turned about its
/// middle, and the result holds all of it: what lies outside are holes, and there is no coordinate system.
///
/// A new sample is a hole where no old one is nearest to it, and where that one is a hole; by area, where samples get farther apart,
/// where less than half of what its cell covers of the field is known instead. Elsewhere samples without a height do not count
/// and the weights of the others are normalised, of cubic by those of linear. Where the samples that count lie beside the new place
/// on average - at borders, beside holes, and where a new spacing is no whole multiple of the old one - the mean is moved to it along
/// the slope of the plane through the samples around it, so that a plane stays one by every method, everywhere. Heights: sums in
/// double, rounded to float once.
/// Marked where an old marked sample is within half a footprint of s x s. Edge lines go along, points inserted where they
/// would be too far apart, with their figures in new samples.
///
/// Of what is seen under a form heights come about of what is seen, and the form is taken at the new places (moved_form.h), so that
/// nothing between samples is off by how it bends there: the result is what is seen of both together, rounded to float
/// once more. A form that has no place there is left out, heights come about of the samples, and Version::seenOf() of the
/// result is null.
///
/// Errors: more than kMostCoarser, more samples than a field may have (kInput); kCancelled; kFailed without memory. Thread:
/// any; a long job on all workers of the arena; the same bits for any number of threads.
[[nodiscard]] Result<Version> resampled(const Version& field, const ResampleOptions& options,
                                        JobControl& job);

/// Size, spacing and place of what resampled() makes of a field with this grid. No side is more than twice the longest that a
/// field may have.
[[nodiscard]] Grid resampledGrid(const Grid& grid, const ResampleOptions& options);

}  // namespace fettle::engine
