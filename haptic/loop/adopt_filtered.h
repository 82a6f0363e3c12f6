#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"
#include "haptic/loop/adoption.h"

namespace fettle::haptic {

/// `input` with the tiles of `spots` filtered, each from a piece of `input` that includes the filter's reach:
/// bit-identical to applyFilter on the whole field. Errors as applyFilter. Time proportional to the spots and
/// their halo. Thread: any but the loop's.
[[nodiscard]] engine::Result<engine::Version> filterTiles(const engine::Version& input,
                                                          const engine::Version& original,
                                                          const engine::FilterSpec& spec,
                                                          const std::vector<TileSpot>& spots,
                                                          engine::JobControl& job);

/// The live loop for a worker: two requests, each answered within some ticks. The app passes them to the main
/// thread, which owns the rings (CommandKind::kSnapshot and kAdopt with one id).
class AdoptionPort {
 public:
  virtual ~AdoptionPort() = default;

  /// The live version now.
  [[nodiscard]] virtual engine::Result<engine::Version> snapshot() = 0;

  struct Answer {
    bool adopted = false;     ///< false: refused, nothing changed
    engine::Version version;  ///< the live version immediately after
  };
  /// Offers a version made from the last snapshot().
  [[nodiscard]] virtual engine::Result<Answer> adopt(engine::Version version) = 0;

  /// Called before another round, so that the hand can move on: about 20 ms.
  virtual void pause() = 0;
};

struct AdoptionReport {
  int rounds = 0;
  int refusals = 0;
  std::int64_t filtered_again = 0;  ///< tiles, edited ones and their halo
  /// Tiles that were edited until the last round and are still unfiltered: offer them again when the stroke
  /// ends, by adoptFiltered with `base` = `result` = the live version then and `rest` = these.
  std::vector<TileSpot> rest;
};

/// Adopts a filter's result into the live field while a hand keeps editing it. `result` is applyFilter of
/// `base`, an earlier live version. Tiles edited since are filtered with their edits, halo included: where
/// the hand does not edit, the live field ends as applyFilter of that version would be. Strokes on tiles that
/// are already filtered stay: they were made on the filtered surface.
///
/// In rounds. Each takes a snapshot, filters again what was edited, offers the merged version, and determines
/// which tiles were edited in the milliseconds between; only these are left for the next round.
///
/// Errors: kCancelled, memory, those of the port; the live field is then as the last adoption left it,
/// consistent. Thread: a worker; blocks on the port.
[[nodiscard]] engine::Result<AdoptionReport> adoptFiltered(AdoptionPort& port, const engine::Version& base,
                                                           const engine::Version& result,
                                                           const engine::Version& original,
                                                           const engine::FilterSpec& spec, int most_rounds,
                                                           engine::JobControl& job);

}  // namespace fettle::haptic
