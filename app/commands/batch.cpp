#include "app/commands/batch.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <new>

#include <fmt/format.h>

#include "app/terminal.h"
#include "app/work/open_document.h"
#include "app/work/outputs.h"
#include "app/work/streams.h"
#include "engine/formats/formats.h"
#include "engine/io/files/atomic_file.h"
#include "engine/io/files/input_file.h"

namespace fettle::app {

namespace {

bool canBeWritten(const std::string& path) {
  const std::string extension = engine::extensionOf(path);
  return std::ranges::any_of(engine::formats(), [&](const engine::FormatInfo& format) {
    return format.writes && std::ranges::find(format.extensions, extension) != format.extensions.end();
  });
}

std::string outputOf(const std::string& in, const BatchOptions& options) {
  std::filesystem::path name = std::filesystem::path(in).filename();
  if (!options.extension.empty())
    name.replace_extension(options.extension);
  else if (!canBeWritten(in))
    name.replace_extension(".tif");
  return (std::filesystem::path(options.out_dir) / name).string();
}

// During its lifetime, the folders that a batch writes to; those it created are removed at the end if they
// are empty.
class Folders {
 public:
  engine::Status make(const std::string& file) {
    const std::filesystem::path folder = std::filesystem::path(file).parent_path();
    std::error_code error;
    std::vector<std::filesystem::path> missing;
    for (auto at = folder; !at.empty() && !std::filesystem::exists(at, error); at = at.parent_path())
      missing.push_back(at);
    for (auto at = missing.rbegin(); at != missing.rend(); ++at) {
      if (std::filesystem::create_directory(*at, error)) made_.push_back(*at);
      if (error && engine::isDiskError(error.value())) return engine::writeError(at->string(), error.value());
      if (error)
        return engine::inputError(fmt::format("the folder cannot be created: {}", error.message()),
                                  at->string(), "name another or change the permissions of the one above it");
    }
    return {};
  }
  ~Folders() {
    std::error_code ignored;
    // remove() leaves a folder that is not empty.
    for (auto at = made_.rbegin(); at != made_.rend(); ++at) std::filesystem::remove(*at, ignored);
  }
  Folders& operator=(Folders&&) = delete;

 private:
  std::vector<std::filesystem::path> made_;
};

std::string counted(std::size_t number, const char* what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

}  // namespace

void addBatchOptions(Command command, BatchOptions& options) {
  command.add({
      {.name = "IN",
       .to = &options.files,
       .text = "IN OUT: the scan to read and the file to write, format by extension, - for standard input "
               "and output; with --out-dir any number of scans to read, and no OUT",
       .kind = ValueKind::kInput,
       .shown = "IN... OUT",
       .required = true},
      {.name = "--out-dir",
       .to = &options.out_dir,
       .text = "Folder for the output files, each under its scan's name, created if missing; continues "
               "where a scan fails",
       .kind = ValueKind::kFolder},
      {.name = "--to",
       .to = &options.extension,
       .text = "With --out-dir, or - for OUT: format of the output, as extension; without it in a folder "
               "the scan's own, or tif where that cannot be written",
       .kind = ValueKind::kFormat,
       .proposed = extensionWords(&engine::FormatInfo::writes)},
  });
  addForceOption(command, options.replacing);
}

bool writesSession(const BatchTask& task) {
  // A dot alone with a word is a hidden file's name, and has no extension.
  return isSessionPath(isStream(task.out) ? "stdout" + withDot(task.to) : task.out);
}

engine::Result<std::vector<BatchTask>> namedTasks(const BatchOptions& options) {
  std::vector<BatchTask> tasks;
  if (!options.many()) {
    if (options.files.size() != 2)
      return engine::inputError(
          fmt::format("{} given", counted(options.files.size(), "file")), "IN OUT",
          "give a scan to read and a file to write, or --out-dir and any number of scans");
    const std::string& out = options.files[1];
    if (!options.extension.empty() && !isStream(out))
      return engine::inputError("--to needs --out-dir", "--to", "the extension of OUT names the format");
    std::error_code error;
    if (!isStream(out) && (out.ends_with('/') || std::filesystem::is_directory(out, error)))
      return engine::inputError("the output is a folder", out, "name a file in it, or give it as --out-dir");
    tasks.push_back({options.files[0], out, options.extension});
  } else {
    std::map<std::string, std::string> taken;
    for (const std::string& in : options.files) {
      if (isStream(in))
        return engine::inputError("standard input has no name for an output file", in,
                                  "give only it, with a file to write");
      tasks.push_back({in, outputOf(in, options), {}});
      const auto [earlier, fresh] = taken.emplace(tasks.back().out, in);
      if (!fresh)
        return engine::inputError(
            fmt::format("{} and {} would be written to the same file", earlier->second, in), tasks.back().out,
            "use two runs with two folders, or rename one");
    }
  }
  return tasks;
}

engine::Result<std::vector<BatchTask>> batchTasks(const BatchOptions& options,
                                                  const std::vector<std::string>& others,
                                                  engine::JobControl& job) {
  auto tasks = namedTasks(options);
  if (!tasks) return tasks;
  std::vector<Output> outputs;
  std::vector<std::string> inputs = others;
  for (const BatchTask& task : *tasks) {
    outputs.push_back({task.out, OutputKind::kField, task.to, options.many()});
    inputs.push_back(task.in);
  }
  if (auto status = checkOutputs(outputs, inputs, options.replacing, job); !status)
    return tl::unexpected(status.error());
  return tasks;
}

engine::Result<Report> runBatch(
    const std::vector<BatchTask>& tasks, engine::JobControl& job,
    const std::function<engine::Result<Report>(const BatchTask&, engine::JobControl&)>& one) {
  Report files = Report::array();
  std::vector<engine::Error> failures;
  std::size_t done = 0;
  Folders folders;
  {
    BatchState state;
    state.count = tasks.size();
    const ProgressLine line(job, &state);
    for (const BatchTask& task : tasks) {
      if (job.cancelled()) break;
      engine::Result<Report> result = tl::unexpected(engine::Error{});
      try {
        const auto ready = task.out.empty() ? engine::Status{} : folders.make(task.out);
        result = ready ? one(task, job) : tl::unexpected(ready.error());
      } catch (const std::bad_alloc&) {  // of this scan; the next may fit
        result = engine::failure("memory ran out", task.in, "close other programs or take a smaller scan");
      }
      if (result) {
        ++done;
        Report entry{{"in", task.in}};
        if (!task.out.empty()) entry["out"] = task.out;
        entry.update(*result);
        addKeptWarnings(entry);
        files.push_back(std::move(entry));
      } else if (result.error().kind == engine::ErrorKind::kCancelled) {
        job.cancel();
        break;
      } else {
        files.push_back({{"in", task.in}, {"error", result.error().line()}});
        addKeptWarnings(files.back());
        failures.push_back(std::move(result).error());
        // The summary must name the scan; errors of the output name only the output.
        if (failures.back().where != task.in) failures.back().what = task.in + ": " + failures.back().what;
      }
      state.done.fetch_add(1, std::memory_order_relaxed);
    }
  }
  for (const engine::Error& failure : failures) report(failure);
  if (job.cancelled())
    return tl::unexpected(
        engine::Error{engine::ErrorKind::kCancelled,
                      fmt::format("cancelled after {} of {}", done, counted(tasks.size(), "scan")), "",
                      tasks.empty() || tasks.front().out.empty() ? ""
                      : done == 0                                ? "nothing was written"
                                                                 : "the written files are complete"});
  return Report{{"done", done}, {"failed", failures.size()}, {"files", std::move(files)}};
}

int batchStatus(const Report& report) {
  return report.contains("failed") && report["failed"] != 0 ? 1 : 0;
}

void printBatch(const Report& report) {
  if (!report.contains("files")) return printReport(report);
  for (const Report& file : report["files"])
    if (file.contains("error"))
      fmt::print("{}  failed\n", file["in"].get<std::string>());
    else if (file.contains("text"))  // of an estimate
      fmt::print("{}  {}\n", file["in"].get<std::string>(), file["text"].get<std::string>());
    else
      fmt::print("{}  {}{}\n", file["in"].get<std::string>(), file.value("out", ""),
                 file.contains("finished_before") ? "  kept, finished before" : "");
  fmt::print("{} done, {} failed\n", report["done"].get<std::size_t>(), report["failed"].get<std::size_t>());
}

}  // namespace fettle::app
