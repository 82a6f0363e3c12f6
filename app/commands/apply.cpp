#include <algorithm>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/recipe_file.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/terminal.h"
#include "app/work/line_edits.h"
#include "app/work/streams.h"
#include "engine/base/stopwatch.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/noise_range.h"

namespace fettle::app {

namespace {

struct ApplyArguments {
  std::string recipe;
  BatchOptions files;
  int threads = 0;
  ScanOptions reading;
  engine::ExportOptions writing;
};

// One scan on its way through a recipe.
struct Applied {
  engine::Version field;
  const engine::Version& original;
  std::string scan;  // as messages name it
  int threads;
  Report steps = Report::array();
};

engine::Status take(const RecipeFilter& step, Applied& at, engine::JobControl& job) {
  engine::FilterSpec spec = step.spec;
  spec.threads = at.threads;
  if (step.range_sigma) spec.range_sigma = step.range_sigma->in(at.field.grid());
  if (step.max_change) spec.max_change = step.max_change->in(at.field.grid());
  if (spec.scope == engine::FilterScope::kOnlyMarks && at.field.reader().root().marked_children == 0)
    warn(fmt::format("{}: step {} filters marked samples only, and none is marked", at.scan,
                     at.steps.size() + 1));
  const auto ready = engine::withMeasuredRange(spec, at.field, job);
  if (!ready) return tl::unexpected(ready.error());
  auto filtered = engine::applyFilter(at.field, at.original, *ready, job);
  if (!filtered) return tl::unexpected(filtered.error());
  at.field = std::move(filtered->field);
  Report done{{"do", "filter"},
              {"filter", engine::filterOf(spec.kind).word},
              {"changed", filtered->report.changed},
              {"rms_change", filtered->report.rms_change}};
  if (engine::hasRange(spec.kind)) done["range_sigma"] = ready->range_sigma;
  at.steps.push_back(std::move(done));
  return {};
}

engine::Status take(const RecipeEdges& step, Applied& at, engine::JobControl& job) {
  const auto map = engine::findEdges(at.field, step.scale, job);
  if (!map) return tl::unexpected(map.error());
  if (step.become == EdgesBecome::kLines) {
    auto lined = drawSuggestion(at.field, *map, step.choice, job);
    if (!lined) return tl::unexpected(lined.error());
    at.field = *std::move(lined);
    at.steps.push_back({{"do", "locate_edges"}, {"lines", at.field.lines() ? at.field.lines()->size() : 0}});
    return {};
  }
  auto marked = engine::suggestMarks(at.field, *map, step.choice, job);
  if (!marked) return tl::unexpected(marked.error());
  at.field = std::move(marked->field);
  at.steps.push_back({{"do", "mark_edges"}, {"lines", marked->lines}, {"samples", marked->samples}});
  return {};
}

engine::Status take(const RecipeInvert&, Applied& at, engine::JobControl&) {
  at.field = at.field.inverted();
  at.steps.push_back({{"do", "invert"}});
  return {};
}

engine::Result<Report> applyToOne(const ApplyArguments& options, const Recipe& recipe, const BatchTask& task,
                                  engine::JobControl& job) {
  auto imported = loadScan(task.in, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const engine::Version original = imported->original ? *imported->original : imported->field;
  const engine::Stopwatch watch;
  Applied at{imported->field, original, shownInput(task.in), options.threads};
  for (std::size_t k = 0; k < recipe.steps.size(); ++k)
    if (auto done = std::visit([&](const auto& step) { return take(step, at, job); }, recipe.steps[k]);
        !done) {
      engine::Error error = done.error();
      if (error.kind != engine::ErrorKind::kCancelled)
        error.what = fmt::format("step {} of the recipe: {}", k + 1, error.what);
      return tl::unexpected(std::move(error));
    }
  const double seconds = watch.seconds();
  engine::ExportOptions writing = options.writing;
  writing.original = original;
  if (auto status = saveField(at.field, task.out, job, writing, task.to); !status)
    return tl::unexpected(status.error());
  return Report{{"steps", at.steps}, {"seconds", seconds}, {"hash", hashOf(at.field)}};
}

engine::Result<Report> apply(const ApplyArguments& options, engine::JobControl& job) {
  if (isStream(options.recipe) &&
      std::any_of(options.files.files.begin(), options.files.files.end() - 1, isStream))
    return engine::inputError("recipe and scan cannot both be standard input", "-", "name one of them");
  const auto recipe = readRecipe(options.recipe, job);
  if (!recipe) return tl::unexpected(recipe.error());
  const auto tasks = batchTasks(options.files, {isStream(options.recipe) ? "" : options.recipe}, job);
  if (!tasks) return tl::unexpected(tasks.error());
  if (auto status = checkCompress(options.writing, *tasks); !status) return tl::unexpected(status.error());
  const auto one = [&](const BatchTask& task, engine::JobControl& j) {
    return applyToOne(options, *recipe, task, j);
  };
  if (options.files.many()) return runBatch(*tasks, job, one);
  const ProgressLine progress(job);
  return one(tasks->front(), job);
}

}  // namespace

void addApply(Command root, Chosen& chosen) {
  auto options = std::make_shared<ApplyArguments>();
  Command command = addCommand(
      root, chosen, "apply", "Do the steps of a recipe to scans",
      [options](engine::JobControl& job) { return apply(*options, job); }, printBatch, Progress::kOwn,
      batchStatus);
  command.add({{.name = "RECIPE",
                .to = &options->recipe,
                .text = "The recipe, as fettle recipe prints it, TOML",
                .kind = ValueKind::kInput,
                .required = true}});
  addBatchOptions(command, options->files);
  command.add({{.name = "--threads",
                .to = &options->threads,
                .text = "Threads to use",
                .range = Range{0.0, engine::FilterSpec::kMaxThreads},
                .otherwise = "0, one per core"}});
  addCompressOption(command, options->writing);
  addScanOptions(command, options->reading);
  command.notes(
      "docs/formats.md describes the keys of a recipe. A filter without range_sigma takes that of each "
      "scan's own "
      "noise.");
  command.examples({{"fettle apply clean.toml scan.tif clean.tif", "One scan"},
                    {"fettle apply clean.toml scan.tif other.tif --out-dir cleaned",
                     "The same steps for two scans, into a folder"}});
}

}  // namespace fettle::app
