#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"
#include "haptic/loop/adoption.h"

namespace fettle::haptic {

/// `input` with the tiles of `spots` filtered, each from a piece of `input` that reaches as far as the filter
/// does: the same bits as applyFilter on the whole field gives there. Errors as applyFilter.
/// Time in proportion to the spots and their halo. Thread: any but the loop's.
[[nodiscard]] engine::Result<engine::Version> filterTiles(const engine::Version& input,
                                                          const engine::Version& original,
                                                          const engine::FilterSpec& spec,
                                                          const std::vector<TileSpot>& spots,
                                                          engine::JobControl& job);

/// The live loop as a worker sees it: two questions, each answered within some ticks. The app carries them to
/// the main thread, which owns the rings (CommandKind::kSnapshot and kAdopt with one id).
class AdoptionPort {
 public:
  virtual ~AdoptionPort() = default;

  /// The live version now.
  [[nodiscard]] virtual engine::Result<engine::Version> snapshot() = 0;

  struct Answer {
    bool adopted = false;     ///< false: refused, nothing changed
    engine::Version version;  ///< the live version right after
  };
  /// Offers a version made from the last snapshot().
  [[nodiscard]] virtual engine::Result<Answer> adopt(engine::Version version) = 0;

  /// Called before another round, so that a hand has time to move on: some 20 ms.
  virtual void pause() = 0;
};

struct AdoptionReport {
  int rounds = 0;
  int refusals = 0;
  std::int64_t filtered_again = 0;  ///< tiles, edited ones and their halo
  /// Tiles that the hand kept editing to the last round and that are unfiltered still: offer them again when
  /// the stroke ends, by adoptFiltered with `base` = `result` = the live version then and `rest` = these.
  std::vector<TileSpot> rest;
};

/// Brings a filter's result into the live field while a hand goes on touching it. `result` is applyFilter of
/// `base`, an earlier live version. What the hand edited since is filtered with its edits, halo included:
/// where the hand kept still, the live field ends as applyFilter of the version without pause would be.
/// Strokes on what is already filtered stay as they are: they were made on the filtered surface.
///
/// In rounds. Each takes a snapshot, filters again what was edited, offers the merged version, and learns
/// which tiles the hand edited in the milliseconds between; only these are left for the next round.
///
/// Errors: kCancelled, memory, those of the port; the live field is then as the last adoption left it, whole.
/// Thread: a worker; blocks on the port.
[[nodiscard]] engine::Result<AdoptionReport> adoptFiltered(AdoptionPort& port, const engine::Version& base,
                                                           const engine::Version& result,
                                                           const engine::Version& original,
                                                           const engine::FilterSpec& spec, int most_rounds,
                                                           engine::JobControl& job);

}  // namespace fettle::haptic
