#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// Samples [first, last] of a row, all of them holes.
struct HoleRun {
  std::int32_t row = 0, first = 0, last = 0;

  [[nodiscard]] std::int32_t samples() const noexcept { return last - first + 1; }
  friend bool operator==(const HoleRun&, const HoleRun&) = default;
};

/// Samples without a height that are connected along rows and columns.
struct Hole {
  std::size_t first_run = 0, runs = 0;  ///< in Holes::runs
  std::int64_t samples = 0;
  SampleRect box;          ///< the smallest rectangle around it
  bool at_border = false;  ///< some sample of it is one of the field's outermost
  bool cut = false;        ///< it reaches the side of the part that was searched, and may go on beyond
};

/// The holes of a field.
struct Holes {
  std::vector<HoleRun> runs;  ///< hole by hole, in each by row and then column
  std::vector<Hole> holes;    ///< by their first run

  [[nodiscard]] std::span<const HoleRun> runsOf(const Hole& hole) const {
    return std::span(runs).subspan(hole.first_run, hole.runs);
  }
};

/// Finds them. Marked samples belong to none: they stay as they are. Connected components of runs (Rosenfeld, Pfaltz
/// 1966). Time: a look at each tile, and the samples of tiles with holes; memory: about 40 bytes per run. The same for
/// any number of threads. Errors: kCancelled. Throws std::bad_alloc. Thread: any; a job on all workers of the arena.
[[nodiscard]] Result<Holes> findHoles(const Version& field, JobControl& job);

/// The same in a part of the field, which lies in it: those that are not cut are holes of the field.
[[nodiscard]] Result<Holes> findHoles(const Version& field, const TileRange& part, JobControl& job);

}  // namespace fettle::engine
