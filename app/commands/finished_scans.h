#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/commands/batch.h"
#include "app/report.h"
#include "engine/base/error.h"
#include "engine/field/grid.h"
#include "engine/io/export.h"

namespace fettle::app {

/// Which scans of a batch with --resume are finished: a note next to each output (OUT.finished, JSON) with what the
/// output was made of, its size and time, and the report of its work. The notes are removed when every scan of the
/// batch is finished, so that a batch that was cut off works out only what is missing.
class FinishedScans {
 public:
  /// One that is not active, of a single output or without --resume, neither reads nor writes notes.
  explicit FinishedScans(bool active) : active_(active) {}

  /// The report of the run that made `out` from the same, with `finished_before` true; nothing where that is not known
  /// or the output was changed or removed since. `identity`: every input that the output depends on.
  [[nodiscard]] std::optional<Report> earlier(const std::string& out, const std::string& identity) const;

  /// The output is written. A note that cannot be written is a warning: the work is done.
  void add(const std::string& out, const std::string& identity, const Report& report) const;

  /// Removes the notes where `batch`, the report of runBatch(), has no failure; else says that they remain.
  void end(const std::vector<BatchTask>& tasks, const Report& batch) const;

 private:
  bool active_;
};

/// What the bytes of an output depend on beside samples and steps: its grid, and how it is written.
[[nodiscard]] std::string writingIdentity(const engine::Grid& grid, const engine::ExportOptions& writing);

}  // namespace fettle::app
