#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/field/version.h"

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

}  // namespace fettle::haptic
