#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/inspect/noise_parts.h"

namespace fettle::engine {

/// The noise of a scan: how large it is, what of it neighbours share, and where it is larger.
struct NoiseModel {
  /// Standard deviation of a sample over the field, but for places twice as loud as its quieter quarter and more, offsets of rows and columns included [height_unit]; NaN for
  /// a field without 3 x 3 samples.
  double sigma = 0.0;
  /// What it consists of [height_unit^2]; their variance() is sigma^2.
  NoiseParts parts;
  /// Of the variances of offsets in `parts` what holds in whole rows and columns [height_unit^2], not only in a window.
  double whole_rows = 0.0, whole_columns = 0.0;
  std::int64_t windows = 0;  ///< that it was measured in; 0: from the finest detail alone
  /// Share of the variance that is not sure, as a standard error: what few windows leave open, and what the finest detail in both
  /// directions lacks of it beyond that, 0 .. 1. Kinks of a surface that are in every window, and roughness from sample to sample, have
  /// it along rows and columns, but hardly in both directions at once: where they count as noise of twice its variance this is 0.5.
  /// Of what lines share half is not sure.
  double doubt = 0.0;

  /// Standard deviation in kMapSide x kMapSide equal parts of the field, row by row from its first sample; sigma
  /// where nothing could be measured, and drawn to it by what few windows leave open.
  static constexpr int kMapSide = 8;
  std::vector<double> map;

  /// That of uncorrelated noise against sigma^2, 0 .. 1.
  [[nodiscard]] double uncorrelatedShare() const noexcept;
  /// At a sample: linear between the middles of the map's parts.
  [[nodiscard]] double sigmaAt(const Grid& grid, std::int32_t column, std::int32_t row) const noexcept;
};

/// Measures the noise of a field in up to some 8,000 windows of 16 x 16 samples, evenly spread: a smooth surface is
/// fitted to each and removed, and what is left in the windows that are quiet and show no edge gives the second moments
/// of the noise (noise_moments.h). Quiet: the detail is at most 4 times (2 in standard deviations) that of the quieter
/// ones of the field, and 1.6 times that of the quieter ones of its 64th of the field. An edge, or another form that the fit
/// does not follow: more of low frequency than other windows, for the finest detail of that part of the field.
/// A field without such a window has what estimateNoise (noise.h) finds, uncorrelated; where edges are in every window, so
/// that more than 9 times the variance of the finest detail would come out, that detail counts, uncorrelated. Windows
/// without any detail, as of a mask or a fill value, do not count.
///
/// Sigma is a mean over 64 parts of the field, of the windows of each; of the parts, what is louder than nine in ten counts
/// as much as that one. Noise that is added to a scan adds its variance, within 5 % of sigma on real scans, unless most of what
/// was found before is texture (docs/decisions/noise-model.md). On all simulated parts, noise 1 and 3, 384 to
/// 2048 samples a side, with and without mixed pixels, sigma is within 5 % of the root mean square of scan less truth.
/// Spikes do not count. Limits: what is correlated along rows and along columns counts as surface, as
/// in a scan that was filtered; a surface that is rough from sample to sample in one direction counts as noise; along
/// rows nothing is seen beyond kNoiseLags samples but the offset of the whole window.
///
/// Bit-identical for any number of threads and for the inverted version. Errors: kCancelled. Throws std::bad_alloc.
/// Thread: any; a tenth of a second or two for any size of field, on all workers of the calling arena.
[[nodiscard]] Result<NoiseModel> measureNoise(const Version& field, JobControl& job);

}  // namespace fettle::engine
