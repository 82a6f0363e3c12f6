#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/accuracy/study.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::bench {

/// A scan of the user, studied in addition to the fields that the studies generate.
struct StudiedScan {
  std::string name;
  engine::Version field;
};

struct AccuracyOptions {
  std::optional<StudiedScan> scan;
  /// 1: as in docs/accuracy.md; smaller values reduce the work in proportion, for a quick run or a test. 0.01
  /// .. 1.
  double effort = 1.0;
  /// Of suggestionStudy: seeds of the noise, 1 .. 100, and samples along each side of its scans, 64 .. 4096; none: by
  /// the effort.
  std::optional<int> seeds{}, side{};
  /// Of suggestionStudy and processStudy: parts of the catalogue; none: all.
  std::vector<std::string> parts{};
  /// Of suggestionStudy: the filters (engine::methodOf) that are run on the scans, besides the one that is named;
  /// "named": that one alone; none: all.
  std::vector<std::string> methods{};
};

// Each study runs on the calling thread, except the code it measures. All are deterministic apart from times.
// Progress: one stage each. Errors: kCancelled; kFailed when memory or a device is missing.

/// Levels of contact on a flat, a wall, ridges, a groove, noise and the scan: force error at 1 N/mm against
/// the true closest point, over nanoseconds per tick, with the same strokes for all of them.
[[nodiscard]] engine::Result<Study> contactStudy(const AccuracyOptions& options, engine::JobControl& job);

/// The source's search word for word beside levels paper, descent and certified, on grounds where a search goes astray:
/// mean distance to the point felt, over nanoseconds per tick. Not on the scan.
[[nodiscard]] engine::Result<Study> paperStudy(const AccuracyOptions& options, engine::JobControl& job);

/// The surface of a cell: a bilinear patch or two triangles, in double or float, near the field's corner and
/// 8 m away from it. Error: distance of the closest points of one cell.
[[nodiscard]] engine::Result<Study> surfaceStudy(const AccuracyOptions& options, engine::JobControl& job);

/// The loop's rate, 0.5 to 10 kHz, in closed loop with a simulated hand that taps, presses and slides: force
/// error against 40 kHz, share of a processor. Not on the scan: a hand works in millimetres, whatever the
/// size of the scan.
[[nodiscard]] engine::Result<Study> rateStudy(const AccuracyOptions& options, engine::JobControl& job);

/// The same rates and hand: energy that the surface, a spring, gives out where it should give none.
[[nodiscard]] engine::Result<Study> energyStudy(const AccuracyOptions& options, engine::JobControl& job);

/// The picture's level of detail: difference from the picture of every sample, over frame time.
[[nodiscard]] engine::Result<Study> detailStudy(const AccuracyOptions& options, engine::JobControl& job);

/// Algorithms for a Gaussian and a median, exact and approximate, over samples per second.
[[nodiscard]] engine::Result<Study> filterStudy(const AccuracyOptions& options, engine::JobControl& job);

/// Bits per sample that are uploaded for the picture: 32-bit floats against 16 bits, whole field or each
/// tile.
[[nodiscard]] engine::Result<Study> uploadStudy(const AccuracyOptions& options, engine::JobControl& job);

/// Cleaning a simulated scan whose truth is known: filters alone and around marks, error near edges over
/// seconds.
[[nodiscard]] engine::Result<Study> restorationStudy(const AccuracyOptions& options, engine::JobControl& job);

/// Filters alone on several simulated parts, noises and seeds: error over all, on flats and near edges.
[[nodiscard]] engine::Result<Study> automaticStudy(const AccuracyOptions& options, engine::JobControl& job);

/// The paper's process with box and median, total and generalised variation, each with and without a hand, and with true
/// lines: error over all, on flats and near edges, over the hand's seconds, for several parts, noises and hands.
[[nodiscard]] engine::Result<Study> processStudy(const AccuracyOptions& options, engine::JobControl& job);

/// Lines located from a simulated hand's strokes along the true edges of simulated scans: distance from the edges,
/// over time per stroke length.
[[nodiscard]] engine::Result<Study> edgeLineStudy(const AccuracyOptions& options, engine::JobControl& job);

/// Generalised variation alone, with the lines of a simulated hand as drawn and as located, and with the true lines:
/// error over all, on flats and near edges, for every part, noise and hand.
[[nodiscard]] engine::Result<Study> handStudy(const AccuracyOptions& options, engine::JobControl& job);

/// A simulated hand that follows findWorthPlaces(), and one that takes the longest edges first: error over seconds.
[[nodiscard]] engine::Result<Study> worthStudy(const AccuracyOptions& options, engine::JobControl& job);

/// What suggestFilter expects every filter that it tries to leave, over what it leaves: every simulated part, two noises.
[[nodiscard]] engine::Result<Study> suggestionStudy(const AccuracyOptions& options, engine::JobControl& job);

}  // namespace fettle::bench
