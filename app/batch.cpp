#include "app/batch.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <new>

#include <fmt/format.h>

#include "app/scan_options.h"
#include "app/terminal.h"
#include "engine/io/import.h"

namespace fettle::app {

namespace {

bool canBeWritten(const std::string& path) {
  const std::string extension = extensionOf(path);
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

std::string counted(std::size_t number, const char* what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

}  // namespace

void addBatchOptions(CLI::App* command, BatchOptions& options) {
  command
      ->add_option("FILES", options.files,
                   "IN OUT: the scan to read and the file to write, format by extension; with --out-dir all "
                   "are scans to read")
      ->required();
  command->add_option("--out-dir", options.out_dir,
                      "Folder for what is written, each under its scan's name; goes on where a scan fails");
  command->add_option("--to", options.extension,
                      "With --out-dir: format of what is written, as extension; else the scan's own, or tif");
}

engine::Result<std::vector<BatchTask>> batchTasks(const BatchOptions& options,
                                                  const std::vector<std::string>& others) {
  std::vector<BatchTask> tasks;
  if (!options.many()) {
    if (options.files.size() != 2)
      return engine::inputError(
          fmt::format("{} given", counted(options.files.size(), "file")), "IN OUT",
          "give a scan to read and a file to write, or --out-dir and any number of scans");
    if (!options.extension.empty())
      return engine::inputError("--to needs --out-dir", "--to", "the extension of OUT names the format");
    tasks.push_back({options.files[0], options.files[1]});
  } else {
    std::map<std::string, std::string> taken;
    for (const std::string& in : options.files) {
      tasks.push_back({in, outputOf(in, options)});
      const auto [earlier, fresh] = taken.emplace(tasks.back().out, in);
      if (!fresh)
        return engine::inputError(fmt::format("{} and {} would be written to one file", earlier->second, in),
                                  tasks.back().out, "give them to two runs with two folders, or rename one");
    }
  }
  std::vector<Output> outputs;
  std::vector<std::string> inputs = others;
  for (const BatchTask& task : tasks) {
    outputs.push_back({task.out, OutputKind::kField});
    inputs.push_back(task.in);
  }
  if (auto status = checkOutputs(outputs, inputs); !status) return tl::unexpected(status.error());
  return tasks;
}

engine::Result<Report> runBatch(
    const std::vector<BatchTask>& tasks, engine::JobControl& job,
    const std::function<engine::Result<Report>(const BatchTask&, engine::JobControl&)>& one) {
  Report files = Report::array();
  std::vector<engine::Error> failures;
  std::size_t done = 0;
  {
    BatchState state;
    state.count = tasks.size();
    const ProgressLine line(job, &state);
    for (const BatchTask& task : tasks) {
      if (job.cancelled()) break;
      engine::Result<Report> result = tl::unexpected(engine::Error{});
      try {
        result = one(task, job);
      } catch (const std::bad_alloc&) {  // of this scan; the next may fit
        result = engine::failure("memory ran out", task.in, "close other programs or take a smaller scan");
      }
      if (result) {
        ++done;
        Report entry{{"in", task.in}, {"out", task.out}};
        entry.update(*result);
        files.push_back(std::move(entry));
      } else if (result.error().kind == engine::ErrorKind::kCancelled) {
        job.cancel();
        break;
      } else {
        files.push_back({{"in", task.in}, {"error", result.error().line()}});
        failures.push_back(std::move(result).error());
        // Whoever reads the summary must know the scan; errors of the output name that alone.
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
                      done == 0 ? "nothing was written" : "what was written is whole"});
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
    else
      fmt::print("{}  {}\n", file["in"].get<std::string>(), file["out"].get<std::string>());
  fmt::print("{} done, {} failed\n", report["done"].get<std::size_t>(), report["failed"].get<std::size_t>());
}

}  // namespace fettle::app
