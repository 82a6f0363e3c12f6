#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bench/accuracy/study.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::bench {

/// A scan of the user's, to be studied beside the fields that the studies make themselves.
struct StudiedScan {
  std::string name;
  engine::Version field;
};

struct AccuracyOptions {
  std::optional<StudiedScan> scan;
  /// 1: as printed in docs/accuracy.md; less is as much less work, for a look or a test. 0.01 .. 1.
  double effort = 1.0;
};

// Each study runs alone on the calling thread but for what it studies. All are deterministic but for their
// times. Progress: a stage of its own each. Errors: kCancelled; kFailed when memory or a device is missing.

/// Levels of contact on a flat, a wall, ridges, a groove, noise and the scan: force error at 1 N/mm against
/// the true closest point, over nanoseconds a tick, one hand over the same way for all of them.
[[nodiscard]] engine::Result<Study> contactStudy(const AccuracyOptions& options, engine::JobControl& job);

/// What a cell is taken for: a bilinear patch or two triangles, in double or float, near the field's corner
/// and 8 m away from it. Error: distance of the closest points of one cell.
[[nodiscard]] engine::Result<Study> surfaceStudy(const AccuracyOptions& options, engine::JobControl& job);

/// The loop's rate, 0.5 to 10 kHz, in closed loop with a simulated hand that taps, presses and slides: force
/// error against 40 kHz, share of a processor. Not on the scan: a hand is of
/// millimetres, whatever the scan is of.
[[nodiscard]] engine::Result<Study> rateStudy(const AccuracyOptions& options, engine::JobControl& job);

/// The same rates and hand: what the surface, a spring, gives out where it should give nothing.
[[nodiscard]] engine::Result<Study> energyStudy(const AccuracyOptions& options, engine::JobControl& job);

/// The picture's level of detail: difference from the picture of every sample, over frame time.
[[nodiscard]] engine::Result<Study> detailStudy(const AccuracyOptions& options, engine::JobControl& job);

/// Ways to work out a Gaussian and a median, exact and approximate, over samples a second.
[[nodiscard]] engine::Result<Study> filterStudy(const AccuracyOptions& options, engine::JobControl& job);

/// Bits a sample that are uploaded for the picture: 32-bit floats against 16 bits, whole field or each tile.
[[nodiscard]] engine::Result<Study> uploadStudy(const AccuracyOptions& options, engine::JobControl& job);

/// Cleaning a simulated scan whose truth is known: filters alone and around marks, error near edges over
/// seconds.
[[nodiscard]] engine::Result<Study> restorationStudy(const AccuracyOptions& options, engine::JobControl& job);

}  // namespace fettle::bench
