#include "app/commands/resume_option.h"

#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/streams.h"

namespace fettle::app {

void addResumeOptions(Command command, ResumeOptions& options) {
  command.add(
      {{.name = "--resume",
        .to = &options.resume,
        .text =
            "Keep finished work in OUT.resume while filtering, and continue with what an earlier "
            "run that was "
            "cut off left there; removed when OUT is written. With --out-dir scans that are finished are not "
            "done again"},
       {.name = "--resume-every",
        .to = &options.every_seconds,
        .text = "With --resume: time between two times that finished work is kept; 0: each part at once",
        .range = Range{0.0, std::numeric_limits<double>::infinity()},
        .unit = "seconds",
        .otherwise = fmt::format("{:g}", engine::KeepOptions{}.every_seconds)}},
      kLongWork);
}

std::string keptWorkOf(const std::string& out) {
  return out + ".resume";
}

engine::Status checkResume(const ResumeOptions& options, const std::vector<BatchTask>& tasks) {
  if (options.every_seconds && !options.resume)
    return engine::inputError("no work is kept that could be written so often", "--resume-every",
                              "add --resume");
  for (const BatchTask& task : tasks) {
    if (options.resume && isStream(task.out))
      return engine::inputError("work cannot be kept next to standard output", "--resume", "name a file");
    if (options.resume && memoryPlace(task.out) != nullptr)
      return engine::inputError("work cannot be kept next to a result in memory", "--resume",
                                "call the program fettle with files");
    if (options.resume || isStream(task.out)) continue;
    const std::string work = keptWorkOf(task.out), rounds = engine::KeptWork::roundsOf(work);
    std::error_code error;
    for (const std::string& file : {work, rounds}) {
      if (!std::filesystem::exists(file, error)) continue;
      warn(fmt::format("{}: work of an earlier run is kept here and not used, give --resume to continue it",
                       file));
      break;
    }
  }
  return {};
}

engine::Result<std::unique_ptr<engine::KeptWork>> openKeptWork(
    const ResumeOptions& options, const std::string& out, const engine::Version& input,
    const engine::Version& original, const engine::FilterSpec& spec, const std::string& device) {
  if (!options.resume) return std::unique_ptr<engine::KeptWork>();
  engine::KeepOptions keep;
  keep.path = keptWorkOf(out);
  if (options.every_seconds) keep.every_seconds = *options.every_seconds;
  keep.on_trouble = [](const engine::Error& error) {
    warn(fmt::format("{}: finished work is not kept until this is mended, the work goes on", error.line()));
  };
  auto kept =
      engine::KeptWork::open(std::move(keep), engine::identityOf(input, original, spec, device), input);
  if (kept && (*kept)->damagedBytes() > 0)
    warn(fmt::format("{}: the last {} bytes are incomplete or damaged, what they held is worked out again",
                     keptWorkOf(out), (*kept)->damagedBytes()));
  return kept;
}

engine::Error continued(engine::Error error, const std::string& out, std::unique_ptr<engine::KeptWork> kept) {
  if (kept == nullptr) return error;
  kept.reset();  // writes what is finished
  if (error.kind == engine::ErrorKind::kCancelled)
    error.remedy = fmt::format("the same command continues with what is kept in {}", keptWorkOf(out));
  else
    error.remedy += fmt::format("{}the same command then continues with what is kept in {}",
                                error.remedy.empty() ? "" : ", ", keptWorkOf(out));
  return error;
}

engine::Error stillKept(engine::Error error, const ResumeOptions& options, const std::string& out) {
  std::error_code unknown;
  if (!options.resume || error.kind != engine::ErrorKind::kCancelled ||
      !std::filesystem::exists(keptWorkOf(out), unknown))
    return error;
  error.remedy = fmt::format("the same command continues with what is kept in {}", keptWorkOf(out));
  return error;
}

void addKept(Report& report, const engine::KeptWork* kept, int passes) {
  if (kept == nullptr) return;
  report["resumed_share"] = kept->shareAtStart(passes);
  if (kept->roundsAtStart() > 0) report["resumed_rounds"] = kept->roundsAtStart();
  report["kept_bytes"] = kept->mostBytes();
  report["kept_seconds"] = kept->secondsWriting();
}

}  // namespace fettle::app
