#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"

namespace fettle::haptic {

/// A tile by its column and row of tiles.
struct TileSpot {
  std::int32_t column = 0;
  std::int32_t row = 0;
  friend bool operator==(const TileSpot&, const TileSpot&) = default;
};

/// The result of a job merged into a later state of the field.
struct MergedResult {
  engine::Version version;
  /// Tiles that the job changed and that were edited since it began: left as `now` has them, row-major within
  /// each node. Their result is only known after filtering again.
  std::vector<TileSpot> conflicts;
};

/// Puts into `now` all tiles in which `result` differs from `base`, except where `now` no longer has base's
/// tile. Compares addresses, which suffices: `base` keeps its tiles, so no other tile can have their address.
/// This step of an adoption takes time proportional to what the job changed; the worker does it so that the
/// loop's part is O(1) plus the tiles edited meanwhile (see LoopTick).
///
/// All three versions are of one grid and share their memory. The sign is `now`'s. Errors: kFailed when
/// memory runs out. Thread: any but the loop's (may grow the pool).
[[nodiscard]] engine::Result<MergedResult> mergeResult(const engine::Version& now,
                                                       const engine::Version& base,
                                                       const engine::Version& result);

/// The tiles that must be filtered again when `edited` tiles changed and a sample's result depends on samples
/// up to `reach_samples` away: these tiles and their neighbours, each once, row-major.
[[nodiscard]] std::vector<TileSpot> withHalo(const std::vector<TileSpot>& edited, std::int32_t reach_samples,
                                             const engine::Grid& grid);

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
