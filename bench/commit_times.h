#pragma once

#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::bench {

/// Times for storing strokes in a session, one value per stroke.
struct CommitTimes {
  std::vector<double> durable_ms;  ///< from the stroke's end until it and its ticks are flushed to the disk
  std::vector<double> waits_ms;    ///< of that, on the window's thread: making and passing on the step
  std::vector<double> tiles;       ///< that the stroke changed
};

/// Brushes `strokes` strokes of a second each (smoothing, radius 8 samples, 50 mm/s), one after the other,
/// and stores each as the window does: a snapshot, a step of the history, the journal with every tick, one
/// transaction of the session's own writer, flushed (Durability::kPowerFailure). The session holds the scan,
/// as one that was saved under a name may: its tables grow with the field. It is created in a temporary
/// folder in that of the tile store, which is on a disk, and removed.
///
/// The loop's thread only takes the snapshot, which is included in the window's share here.
/// Errors: kInput where the session cannot be written, kCancelled. Thread: any; blocks.
[[nodiscard]] engine::Result<CommitTimes> commitTimes(const engine::Version& field, int strokes,
                                                      engine::JobControl& job);

}  // namespace fettle::bench
