#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::bench {

struct HapticBenchOptions {
  std::int32_t side = 4096;        ///< samples along each side of the field, 64 .. 32768
  std::int64_t ticks = 1'000'000;  ///< of each run; certified contact and a ball take a tenth of them
  int repeats = 5;                 ///< 1 .. 100
  /// Of the hand over the field, each > 0. A person follows an edge at about 20.
  std::vector<double> speeds_mm_s = {10.0, 20.0, 50.0};
};

/// One case, run `repeats` times from the same start. Rates in ticks per second.
struct HapticBenchRow {
  std::string ground;  ///< the field: "rough part", "clean part", or a HardGround's name
  std::string name;
  double speed_mm_s = 0.0;
  std::int64_t ticks = 0;
  std::int64_t contact_ticks = 0;
  double median = 0.0;
  double slowest = 0.0;
  double fastest = 0.0;
  // Of single ticks, clock included, from separate passes over at most 100,000 of them [ns], the least of `repeats` for each
  // tick; 0 for the plain search.
  double p50_ns = 0.0;
  double p99_ns = 0.0;
  double p999_ns = 0.0;
  double p9999_ns = 0.0;
  double worst_ns = 0.0;
  // Of a contact, for the lower bounds alone (LeastSearch, LeastBall).
  double cells = 0.0, newton_cells = 0.0, bytes = 0.0;
  /// Of the field after it and of force and proxy in every timed tick; of the forces for the plain search, of the sum for the
  /// lower bound. The same in every repeat, else an error.
  std::uint64_t hash = 0;
};

struct HapticBenchReport {
  std::string machine;
  double copy_bytes_per_s = 0.0;  ///< yardstick, one thread
  std::vector<HapticBenchRow> rows;
};

/// Replays a hand that moves over a milled, noisy workpiece, as fast as possible: the whole tick with
/// collision, contact, force and, where named, 3 x 3 local smoothing; every case at each speed. Then over the
/// same part without noise and over the hard grounds, 1024 samples square, at 20 mm/s. Yardstick of each:
/// PlainSearch over the same strokes; lower bounds: LeastSearch of level paper, LeastBall of the ball. Errors:
/// kInput for options out of range, kCancelled, kFailed when two repeats differ in a bit. Thread: any;
/// blocks.
[[nodiscard]] engine::Result<HapticBenchReport> benchHaptic(const HapticBenchOptions& options,
                                                            engine::JobControl& job);

}  // namespace fettle::bench
