#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/report.h"
#include "engine/resume/kept_work.h"

namespace fettle::app {

/// --resume and --resume-every: finished work of a filter is kept next to OUT, and continued.
struct ResumeOptions {
  bool resume = false;
  std::optional<double> every_seconds;
};
inline constexpr const char* kLongWork = "Long work";  ///< heading of these and of --estimate
void addResumeOptions(Command command, ResumeOptions& options);

/// The file of the kept work of an output.
[[nodiscard]] std::string keptWorkOf(const std::string& out);

/// Refuses --resume-every without --resume, and --resume for standard output. Warns of kept work that is not used
/// because --resume is not given.
[[nodiscard]] engine::Status checkResume(const ResumeOptions& options, const std::vector<BatchTask>& tasks);

/// The kept work of an output, begun where there is none; null without --resume. `device` as
/// FilterCompute::device(). Warns where some of it was damaged. Errors as engine::KeptWork::open.
[[nodiscard]] engine::Result<std::unique_ptr<engine::KeptWork>> openKeptWork(
    const ResumeOptions& options, const std::string& out, const engine::Version& input,
    const engine::Version& original, const engine::FilterSpec& spec, const std::string& device);

/// An error of work that is kept: its remedy says how it goes on. `kept` may be null. On `kept` no method may follow.
[[nodiscard]] engine::Error continued(engine::Error error, const std::string& out,
                                      std::unique_ptr<engine::KeptWork> kept);

/// An error of the work on `out` before its kept work is opened: where the cancelled run of --resume finds kept work of
/// an earlier one, the remedy says so. Every other error stays as it is.
[[nodiscard]] engine::Error stillKept(engine::Error error, const ResumeOptions& options,
                                      const std::string& out);

/// Adds `resumed_share`, `kept_bytes` and `kept_seconds` to a report; nothing where `kept` is null.
void addKept(Report& report, const engine::KeptWork* kept, int passes);

}  // namespace fettle::app
