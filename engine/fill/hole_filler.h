#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/line_cuts.h"
#include "engine/field/live_field.h"
#include "engine/field/version.h"
#include "engine/fill/fill.h"
#include "engine/fill/holes.h"

namespace fettle::engine {

/// The holes that the options allow to fill.
struct ChosenHoles {
  std::vector<const Hole*> holes;  ///< in their order
  std::int64_t samples = 0;
};

/// Those that stay are counted in `counts`, and all. Holes that are cut are chosen by what is known of them.
[[nodiscard]] ChosenHoles chooseHoles(const Holes& holes, const FillOptions& options, const Grid& grid,
                                      Filled& counts);

/// Fills holes of a field, any at a time: each of the heights as they were, so that their order is no matter.
///
/// Threading: one thread at a time; works on all workers of the arena. Throws std::bad_alloc.
class HoleFiller {
 public:
  HoleFiller(const Version& field, const FillOptions& options);

  /// Fills these of `holes`, whole ones all; counted in `counts`. Errors: kCancelled, between two holes; kFailed without memory.
  [[nodiscard]] Status fill(const Holes& holes, std::span<const Hole* const> chosen, Filled& counts,
                            JobControl& job);
  /// Puts heights into the samples of a hole, run by run, in place of what is there: an approximation. False without memory.
  [[nodiscard]] bool put(std::span<const HoleRun> runs, std::span<const float> heights);
  /// The field with what was filled until now.
  [[nodiscard]] Version snapshot() const noexcept { return live_.snapshot(); }

 private:
  [[nodiscard]] bool write(std::span<const HoleRun> runs, const HoleSurface& surface, Filled& counts);

  const Version field_;
  const FillOptions options_;
  const std::optional<LineCuts> walls_;
  LiveField live_;
};

}  // namespace fettle::engine
