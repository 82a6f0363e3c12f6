#pragma once

#include <string>
#include <vector>

#include "app/commands/shards/shard_folder.h"
#include "app/commands/shards/shard_plan.h"
#include "app/report.h"
#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::app {

/// The report of a shard of this plan; null where it is not done, or was done for another plan.
[[nodiscard]] Report reportOfShard(const ShardFolder& folder, const ShardPlan& plan, int number);

struct GatherOptions {
  std::string vrt;    ///< instead of OUT: a VRT over the shards' files
  bool keep = false;  ///< the folder stays
};

/// Puts the result together. Every row is read and held against the hash that its shard stated. Errors (kFailed), which name
/// every shard concerned: one is missing, or its rows are not what it wrote. OUT appears whole or not at all.
[[nodiscard]] engine::Result<Report> gatherBands(const std::string& out, const GatherOptions& options,
                                                 engine::JobControl& job);

/// "1 to 3, 5 and 7".
[[nodiscard]] std::string numbersText(const std::vector<int>& numbers);

}  // namespace fettle::app
