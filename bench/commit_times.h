#pragma once

#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::bench {

/// What keeping strokes in a session takes, a number for each stroke.
struct CommitTimes {
  std::vector<double> durable_ms;  ///< from the stroke's end until it and its ticks are flushed to the disk
  std::vector<double> waits_ms;  ///< of that, the window's thread: the step is made and handed to the writer
  std::vector<double> tiles;     ///< that the stroke changed
};

/// Brushes `strokes` strokes of a second each (smoothing, radius 8 samples, 50 mm/s), one after the other,
/// and keeps each as the window does: a snapshot, a step of the history, the journal with every tick, one
/// transaction of the session's own writer, flushed (Durability::kPowerFailure). The session holds the scan,
/// as one that was saved under a name may: its tables grow with the field. It lies in a folder of its own in
/// the folder of the tile store, which is on a disk, and is removed.
///
/// The hand's thread takes part in none of it but the snapshot, which is in the window's share here: the loop
/// hands versions over and goes on.
/// Errors: kInput where the session cannot be written, kCancelled. Thread: any; blocks.
[[nodiscard]] engine::Result<CommitTimes> commitTimes(const engine::Version& field, int strokes,
                                                      engine::JobControl& job);

}  // namespace fettle::bench
