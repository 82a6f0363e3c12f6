#pragma once

#include <string>
#include <vector>

#include "app/commands/batch.h"
#include "app/report.h"
#include "engine/base/error.h"

namespace fettle::app {

/// The scans of a list that one shard does: every count-th from its number on, so that scans of one size after another are
/// shared out evenly. `shard` as typed; empty: all. Errors (kInput): as parseShard.
[[nodiscard]] engine::Result<std::vector<BatchTask>> tasksOfShard(const std::vector<BatchTask>& tasks,
                                                                  const std::string& shard);

/// Writes what a shard of a list did, the report of its scans, as FOLDER/shards/K-of-N.json. Errors as of writing a file.
[[nodiscard]] engine::Status keepListReport(const std::string& folder, const std::string& shard,
                                            const Report& report);

/// Whether a folder has reports of shards of a list.
[[nodiscard]] bool isListFolder(const std::string& folder);

/// The reports of all shards of a list together: `shards`, `done`, `failed` and `files`, in the order of the list. Errors (kFailed):
/// shards whose reports are missing, which it names, or of different numbers of shards.
[[nodiscard]] engine::Result<Report> gatherList(const std::string& folder);

}  // namespace fettle::app
