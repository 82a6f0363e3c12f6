#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/output_checks.h"

namespace fettle::app {

/// The files of a command that writes one scan for each that it reads, as typed: IN OUT, or any number of IN
/// with a folder for the output.
struct BatchOptions {
  std::vector<std::string> files;
  std::string out_dir;    ///< empty: one scan, IN OUT
  std::string extension;  ///< of files written to out_dir or to "-", with or without a dot; empty: batchTasks
  Replacing replacing = Replacing::kNoWork;

  [[nodiscard]] bool many() const noexcept { return !out_dir.empty(); }
};
void addBatchOptions(Command command, BatchOptions& options);

/// One scan to read and its output.
struct BatchTask {
  std::string in;
  std::string out;  ///< empty: nothing is written
  std::string to;   ///< format of an `out` that is "-", as extension
};

/// Whether a task's output is a session, as a file or to standard output.
[[nodiscard]] bool writesSession(const BatchTask& task);

/// The tasks, in the order typed. In out_dir a scan keeps its name; its extension is that of `options`,
/// otherwise its own where that format can be written, otherwise .tif. Refuses before anything is read
/// (kInput): not exactly IN and OUT without out_dir, an extension without out_dir or "-", two scans with the
/// same output file (naming both). Whether the outputs can be written is not looked at.
[[nodiscard]] engine::Result<std::vector<BatchTask>> namedTasks(const BatchOptions& options);

/// The same; also refuses whatever checkOutputs refuses. `others` are further inputs that no output may replace.
[[nodiscard]] engine::Result<std::vector<BatchTask>> batchTasks(const BatchOptions& options,
                                                                const std::vector<std::string>& others,
                                                                engine::JobControl& job);

/// Runs the tasks one after another with one progress line for all, and continues where one fails. Failures
/// are errors on stderr at the end, one line each. The report holds `done`, `failed` and `files`: one object
/// per task, with `in`, `out` (where there is one) and the report of `one`, or `in` and `error`. batchStatus
/// gives the exit status.
///
/// A missing output folder is created, and removed again when nothing was written. Cancelling ends the
/// current task, which leaves no file, and starts no other: kCancelled, stating how many files were
/// completed.
[[nodiscard]] engine::Result<Report> runBatch(
    const std::vector<BatchTask>& tasks, engine::JobControl& job,
    const std::function<engine::Result<Report>(const BatchTask&, engine::JobControl&)>& one);

/// 0, or 1 when a task of the batch failed; 0 for reports of a single scan.
[[nodiscard]] int batchStatus(const Report& report);

/// One line per task for a batch, printReport for a single scan.
void printBatch(const Report& report);

}  // namespace fettle::app
