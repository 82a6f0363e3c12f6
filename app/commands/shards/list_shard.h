#pragma once

#include <string>
#include <vector>

#include "app/commands/batch.h"
#include "app/report.h"
#include "engine/base/error.h"
#include "engine/shard/bands.h"

namespace fettle::app {

/// One shard of a list of scans: every count-th from its number on, so that scans of one size after another are shared out evenly.
class ListShard {
 public:
  /// `typed`: K/N or auto; empty: all scans, and no report. `folder`: where the shard's report is kept, FOLDER/shards/K-of-N.json; empty:
  /// nowhere. An earlier one is removed, so that a shard that is cut off is not done. `arguments`: the whole command line.
  /// Errors: kInput, as parseShard, and a folder where no report can be written; of removing a file.
  [[nodiscard]] static engine::Result<ListShard> begin(const std::vector<BatchTask>& tasks,
                                                       const std::string& typed, const std::string& folder,
                                                       const std::vector<std::string>& arguments);

  [[nodiscard]] const std::vector<BatchTask>& tasks() const noexcept { return tasks_; }

  /// Keeps what the shard did, the report of its scans. Errors as of writing a file.
  [[nodiscard]] engine::Status keep(const Report& report) const;

 private:
  std::vector<BatchTask> tasks_;
  engine::Shard shard_;
  std::string file_;  // empty: no report
  std::string work_;  // a hash of the command and its list
};

/// Whether a folder has reports of shards of a list.
[[nodiscard]] bool isListFolder(const std::string& folder);

/// The reports of all shards of a list together: `shards`, `done`, `failed` and `files`, in the order of the list. Errors (kFailed):
/// shards whose reports are missing, which it names, of different numbers of shards, or of different commands.
[[nodiscard]] engine::Result<Report> gatherList(const std::string& folder);

}  // namespace fettle::app
