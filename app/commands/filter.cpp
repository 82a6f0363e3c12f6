#include <chrono>
#include <memory>

#include <fmt/format.h>

#include "app/batch.h"
#include "app/command.h"
#include "app/scan_options.h"
#include "app/terminal.h"
#include "engine/filter/filter.h"
#include "engine/io/marks.h"

namespace fettle::app {

namespace {

struct Options {
  BatchOptions files;
  std::string filter;
  int window = 3;
  double sigma = 0.0;
  int passes = 1;
  std::string keep;
  std::string only;
  std::string max_change;
  int threads = 0;
  ScanOptions reading;
};

engine::Result<engine::FilterSpec> specOf(const Options& options) {
  engine::FilterSpec spec;
  spec.kind = *engine::filterKindFromName(options.filter);
  spec.window = options.window;
  spec.sigma = options.sigma;
  spec.passes = options.passes;
  spec.threads = options.threads;
  spec.scope = options.only.empty() ? engine::FilterScope::kKeepMarks : engine::FilterScope::kOnlyMarks;
  if (auto status = engine::validate(spec); !status) return tl::unexpected(status.error());
  return spec;
}

engine::Result<Report> filterOne(const Options& options, engine::FilterSpec spec, const BatchTask& task,
                                 engine::JobControl& job) {
  auto imported = loadScan(task.in, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  engine::Version field = imported->field;
  if (const std::string& marks = options.only.empty() ? options.keep : options.only; !marks.empty()) {
    auto marked = engine::importMarks(field, marks);
    if (!marked) return tl::unexpected(marked.error());
    field = *std::move(marked);
  }
  if (!options.max_change.empty()) {
    const auto limit = parseHeight(options.max_change, field.grid(), "--max-change");
    if (!limit) return tl::unexpected(limit.error());
    spec.max_change = *limit;
  }
  const auto start = std::chrono::steady_clock::now();
  const auto filtered = engine::applyFilter(field, imported->field, spec, job);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!filtered) return tl::unexpected(filtered.error());
  if (auto status = saveField(filtered->field, task.out, job); !status) return tl::unexpected(status.error());

  const double samples = static_cast<double>(field.grid().samples()) * spec.passes;
  return Report{{"filter", options.filter},
                {"window", spec.window},
                {"sigma", spec.sigma},
                {"passes", spec.passes},
                {"unit", field.grid().height_unit.name},
                {"changed", filtered->report.changed},
                {"max_change", filtered->report.max_change},
                {"rms_change", filtered->report.rms_change},
                {"seconds", seconds},
                {"samples_per_second", samples / seconds},
                {"hash", fmt::format("{:016x}", engine::contentHash(filtered->field))}};
}

engine::Result<Report> filter(const Options& options, engine::JobControl& job) {
  const auto spec = specOf(options);
  if (!spec) return tl::unexpected(spec.error());
  const auto tasks = batchTasks(options.files, {options.keep, options.only});
  if (!tasks) return tl::unexpected(tasks.error());
  const auto one = [&](const BatchTask& task, engine::JobControl& j) {
    return filterOne(options, *spec, task, j);
  };
  if (options.files.many()) return runBatch(*tasks, job, one);
  const ProgressLine progress(job);
  return one(tasks->front(), job);
}

}  // namespace

void addFilter(CLI::App& root, Chosen& chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* command = addCommand(
      root, chosen, "filter", "Filter whole scans, around what is marked",
      [options](engine::JobControl& job) { return filter(*options, job); }, printBatch, Progress::kOwn,
      batchStatus);
  addBatchOptions(command, options->files);
  command->add_option("--filter", options->filter, "box, gaussian or median")
      ->required()
      ->check(CLI::IsMember({"box", "gaussian", "median"}));
  command->add_option("--window", options->window, "Side of the window in samples, odd, 1 to 1001")
      ->capture_default_str();
  command->add_option("--sigma", options->sigma,
                      "Gaussian: standard deviation in samples; without it the weights are binomial");
  command->add_option("--passes", options->passes, "How often the filter is applied")->capture_default_str();
  CLI::Option* keep =
      command->add_option("--keep", options->keep, "Picture of marks: these samples keep their bits");
  command->add_option("--only", options->only, "Picture of marks: only these samples are filtered")
      ->excludes(keep);
  command->add_option(
      "--max-change", options->max_change,
      "No sample ends further than this from IN; in the scan's height unit, or as 20um, 0.5mm");
  command->add_option("--threads", options->threads, "Threads to use; 0 = one a core")->capture_default_str();
  addScanOptions(command, options->reading);
}

}  // namespace fettle::app
