#pragma once

#include <functional>
#include <optional>

#include "app/commands/shards/band_work.h"
#include "app/commands/shards/shard_plan.h"
#include "app/report.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/row_span.h"
#include "engine/field/version.h"

namespace fettle::app {

/// Rows of the input as the command has them, and of what a limit is measured against.
struct BandInput {
  engine::Version input, original;
};

/// Some rows of a scan, and the grid of the whole.
struct LoadedBand {
  BandInput field;
  engine::RowSpan rows;
  engine::Grid whole;
};

/// Whether marks, lines or an original, which are of the whole, go with the scan: it is read as a whole then.
[[nodiscard]] bool hasCompanions(const BandWork& work);

/// The field as the command has it. Errors: a form over a session; of reading.
[[nodiscard]] engine::Result<BandInput> wholeOf(const BandWork& work, engine::JobControl& job);

/// The rows that `rows_in` names when the grid is known, alone where the format has them so. Errors of reading.
[[nodiscard]] engine::Result<LoadedBand> loadBand(
    const BandWork& work, const std::function<engine::RowSpan(const engine::Grid&)>& rows_in,
    engine::JobControl& job);

/// Refuses streams, sessions and meshes, and what checkOutputs() refuses.
[[nodiscard]] engine::Status checkBandFiles(const BandWork& work, engine::JobControl& job);

/// What every shard must be told alike.
[[nodiscard]] Report settingsOf(const BandWork& work);

/// The spec with its range and limit, as planned.
[[nodiscard]] std::optional<engine::FilterSpec> plannedSpec(const BandWork& work, const ShardPlan& plan);

}  // namespace fettle::app
