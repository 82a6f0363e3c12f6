#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "haptic/base/sound_tick.h"
#include "haptic/base/strokes.h"
#include "haptic/base/tick_counters.h"
#include "haptic/scene/scene.h"

namespace fettle::haptic {

/// Whether every tick's force is kept.
enum class RecordForces : std::uint8_t { kNo, kYes };
/// Whether each tick's distance is measured against the certified one (several times slower).
enum class MeasureContact : std::uint8_t { kNo, kYes };

struct ReplayOptions {
  RecordForces record_forces = RecordForces::kNo;  ///< 64 bytes per tick
  MeasureContact measure = MeasureContact::kNo;
  /// Called after every tick with what it is heard as, null in a scene without sound. An error ends the replay.
  std::function<engine::Status(const SoundTick* heard, const StrokeSample& input)> listen = {};
};

/// Figures of one replay. All but the two timings are the same for the same input on every machine.
struct ReplayReport {
  std::int64_t ticks = 0;
  std::int64_t contact_ticks = 0;
  double max_force_n = 0.0;
  std::int64_t samples_changed = 0;  ///< samples whose height differs between start and result
  std::int64_t marked = 0;           ///< samples marked in the result
  double seconds = 0.0;              ///< of the ticks alone
  double ticks_per_second = 0.0;
  /// Contact ticks in which the proxy was farther from the endpoint than the certified closest point, by more
  /// than rounding (1e-9 of the distance); counted with MeasureContact::kYes. Never above 0 at level
  /// certified.
  std::int64_t above_certified = 0;
  double worst_excess_mm = 0.0;  ///< largest such difference of distances [mm]
  TickCounters counters;         ///< rare but legal cases
};

struct ReplayResult {
  engine::Version field;  ///< upright, sharing every unchanged tile with the start
  ReplayReport report;
  std::vector<ForceSample> forces;  ///< one per tick, or empty
};

/// Applies a recorded session: one tick per stroke sample, with the tick of the live loop. With the same
/// start, strokes and scene the field and the forces are bit-identical.
///
/// `original` is the field that Scene::max_change is measured against: same grid as `start`, usually the
/// scan as imported; often `start` itself. Strokes and forces are in field coordinates [mm] of the field as
/// felt: with Scene::invert, z is that of the inverted field. A field of one row or one column has no cells,
/// so contact is impossible there.
/// Errors: kInput when the scene is out of range (sceneProblem) or the grids differ; kCancelled; kFailed when
/// memory runs out. Progress: one stage "replaying", steps = ticks.
[[nodiscard]] engine::Result<ReplayResult> replay(const engine::Version& start,
                                                  const engine::Version& original,
                                                  std::span<const StrokeSample> strokes, const Scene& scene,
                                                  const ReplayOptions& options, engine::JobControl& job);

}  // namespace fettle::haptic
