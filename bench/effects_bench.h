#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/instructions.h"
#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::bench {

struct EffectsBenchOptions {
  std::int32_t side = 1024;      ///< samples along each side of the field, 64 .. 32768
  std::int64_t ticks = 100'000;  ///< of each run, 1000 .. 1e8
  int repeats = 9;               ///< 1 .. 100
};

/// Cost of one scene per tick. Times over the repeats, which alternate between all rows, so that a change of
/// the machine's speed affects all of them equally.
struct EffectsBenchRow {
  std::string name;  ///< "none", an effect's name, "all", "sphere tip", "under a plane", ...
  double median_ns = 0.0;
  double fastest_ns = 0.0;
  double worst_ns = 0.0;
  std::optional<double> instructions;  ///< per tick in contact, in user space; none where not available
  std::int64_t bytes = 0;              ///< memory of the effect (the tip, the form); for "all" of all of them
  std::int64_t contact_ticks = 0;
  std::uint64_t hash = 0;  ///< of all forces and of the field after it; the same in every repeat
};

struct EffectsBenchReport {
  std::string machine;
  CountedBy counted_by = CountedBy::kNothing;
  std::vector<EffectsBenchRow> rows;
};

/// The same strokes, first without any effect (contact only), then with each effect of EffectKind alone, then
/// with all of them, then with a ball as tip; and without any effect over fields of the same heights that lie under a
/// form: a plane, a sphere, whose bytes are those of what is seen. Errors: kInput for options out of range, kCancelled, kFailed
/// when two repeats differ in a bit. Thread: any; blocks.
[[nodiscard]] engine::Result<EffectsBenchReport> benchEffects(const EffectsBenchOptions& options,
                                                              engine::JobControl& job);

}  // namespace fettle::bench
