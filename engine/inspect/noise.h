#pragma once

#include <cstdint>
#include <functional>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/row_span.h"
#include "engine/field/version.h"

namespace fettle::engine {

struct NoiseEstimate {
  /// Standard deviation of the noise, as if it were white and Gaussian [height_unit]; NaN without windows.
  double sigma = 0.0;
  std::int64_t windows = 0;  ///< 3 x 3 windows without a hole that were used
};

/// The noise of a field from its finest detail alone: what remains of each sample when the surface around it
/// is removed by the mask
///
///    1 -2  1
///   -2  4 -2      d; for white noise of standard deviation s, d has 6 s (the root of the sum of squares)
///    1 -2  1
///
/// which is 0 on every surface f(x) + x g(y) + h(y) + y k(x): planes, steps and ribs along rows or columns,
/// cylinders (J. Immerkaer, Fast noise variance estimation, 1996). sigma = 1.4826 median(|d|) / 6: the median
/// ignores what a minority of windows contain, such as edges and spikes (F. Hampel, The influence curve and
/// its role in robust estimation, 1974). Windows with a hole or across the border are left out.
///
/// Limits: noise that neighbours share (filtered or interpolated scans, waves, line offsets) is not measured,
/// a rough surface counts as noise. Heights that are counts times a step give multiples of 0.247 steps. Error
/// on white noise: its standard error is 1.2 sigma / sqrt(windows / 9) or less; steps across a share p of the
/// windows raise it by about 1.2 p.
///
/// Signs of the version do not matter. Differences in double, the median exact (the lower of two middle
/// ones); bit-identical for any number of threads. Errors: kCancelled. Thread: any; a long job, on all
/// workers of the calling arena.
[[nodiscard]] Result<NoiseEstimate> estimateNoise(const Version& field, JobControl& job);

/// Gives rows of a field as a field of their own.
using RowsSource = std::function<Result<Version>(RowSpan rows, JobControl& job)>;

/// The same, bit by bit, of a field of which no more than `rows_at_once` rows (a multiple of kTileSide) and two more are in
/// memory. Each row is asked for kSelectPasses times. Errors: of the source; kCancelled.
[[nodiscard]] Result<NoiseEstimate> estimateNoiseByRows(const Grid& grid, const RowsSource& source,
                                                        std::int32_t rows_at_once, JobControl& job);

}  // namespace fettle::engine
