#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/compute_option.h"
#include "app/commands/estimate_option.h"
#include "app/commands/filter_arguments.h"
#include "app/commands/filter_suggestion.h"
#include "app/commands/filter_warnings.h"
#include "app/commands/finished_scans.h"
#include "app/commands/known_steps.h"
#include "app/commands/list_text.h"
#include "app/commands/original_scan.h"
#include "app/commands/output_checks.h"
#include "app/commands/region_option.h"
#include "app/commands/resume_option.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/shards/band_work.h"
#include "app/commands/shards/list_shard.h"
#include "app/commands/shards/plan.h"
#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/streams.h"
#include "engine/base/lower_case.h"
#include "engine/base/memory.h"
#include "engine/base/stopwatch.h"
#include "engine/compare/compare.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/noise_range.h"

namespace fettle::app {

namespace {

// A length that filters of one nesting word take.
struct NestingOption {
  std::string_view word;
  const char* shown;
  const std::string& typed;
  bool (*has)(const engine::Filter& filter);
};

std::array<NestingOption, 2> nestingOptions(const FilterArguments& options) {
  return {{{"cutoff", "cut-off", options.cutoff,
            [](const engine::Filter& filter) { return filter.nesting_word == "cutoff"; }},
           {"radius", "radius", options.radius,
            [](const engine::Filter& filter) { return filter.nesting_word == "radius"; }}}};
}

engine::Result<engine::FilterSpec> specOf(const FilterArguments& options) {
  engine::FilterSpec spec;
  const engine::Filter& filter = *engine::filterNamed(options.filter);
  if (!options.lines.empty() && !filter.knows_lines)
    return engine::inputError(
        fmt::format("{} knows no edge lines", filter.word), "--lines",
        fmt::format("take --filter {}", engine::filterWords(engine::knowsLines, " or ")));
  spec.kind = filter.kind;
  spec.window = options.window;
  spec.sigma = options.sigma;
  for (const NestingOption& option : nestingOptions(options)) {
    if (option.typed.empty()) continue;
    if (filter.nesting_word != option.word)
      return engine::inputError(fmt::format("{} has no {}", filter.word, option.shown),
                                fmt::format("--{}", option.word),
                                fmt::format("take --filter {}", engine::filterWords(option.has, " or ")));
    // In millimetres: the default unit of a grid.
    const auto length = parseHeight(option.typed, engine::Grid{}, fmt::format("--{}", option.word));
    if (!length) return tl::unexpected(length.error());
    spec.nesting_mm = *length;
  }
  spec.element = static_cast<engine::Element>(std::ranges::find(engine::kElementWords, options.element) -
                                              engine::kElementWords.begin());
  spec.passes = options.passes;
  spec.threads = options.threads;
  spec.scope = options.only.empty() ? engine::FilterScope::kKeepMarks : engine::FilterScope::kOnlyMarks;
  // The scan's unit and noise are not known yet.
  engine::FilterSpec ranged = spec;
  if (filter.range_sigma.exists() || !options.range_sigma.empty()) ranged.range_sigma = 1.0;
  if (auto status = engine::validate(ranged); !status) return tl::unexpected(status.error());
  return spec;
}

// What a session that is written notes of this filter; `spec` as typed.
engine::Status noteSteps(const FilterArguments& options, engine::FilterSpec spec, const BatchTask& task,
                         const engine::Imported& imported, engine::ExportOptions& writing,
                         engine::JobControl& job) {
  auto known = KnownSteps::of(imported, task, job);
  if (!known) return tl::unexpected(known.error());
  const engine::Grid& grid = imported.field.grid();
  RecipeFilter step;
  if (engine::hasRange(spec.kind) && spec.range_sigma > 0.0)
    step.range_sigma = recipeLength(spec.range_sigma, grid);
  if (spec.max_change) step.max_change = recipeLength(*spec.max_change, grid);
  spec.range_sigma = 0.0;
  spec.max_change.reset();
  step.spec = spec;
  if (!options.original.empty())
    known->leftOut("what was done before the filter to the scan that --original names");
  for (const auto& [file, option] :
       {std::pair(&options.keep, "--keep"), {&options.only, "--only"}, {&options.lines, "--lines"}})
    if (!file->empty())
      known->leftOut(fmt::format("the {} of {}: they belong to this scan",
                                 file == &options.lines ? "edge lines" : "marks", option));
  known->did(step);
  known->note(writing);
  return {};
}

engine::Result<Report> filterOne(const FilterArguments& options, engine::FilterSpec spec,
                                 FilterCompute& compute, const BatchTask& task, engine::JobControl& job) {
  auto imported = loadScan(task.in, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const auto original = originalOf(*imported, options.original, options.reading, job);
  if (!original) return tl::unexpected(original.error());
  auto marked = withMarks(imported->field, options.only.empty() ? options.keep : options.only, job);
  if (!marked) return tl::unexpected(marked.error());
  auto lined = withLines(*marked, options.lines, job);
  if (!lined) return tl::unexpected(lined.error());
  const engine::Version field = *std::move(lined);
  if (!options.max_change.empty()) {
    const auto limit = parseHeight(options.max_change, field.grid(), "--max-change");
    if (!limit) return tl::unexpected(limit.error());
    spec.max_change = *limit;
  }
  if (!options.range_sigma.empty()) {
    const auto range = parseHeight(options.range_sigma, field.grid(), "--range-sigma");
    if (!range) return tl::unexpected(range.error());
    spec.range_sigma = *range;
    // 0 would select the noise's.
    if (auto status = engine::validate(spec); !status) return tl::unexpected(status.error());
  }
  const engine::FilterSpec typed = spec;
  const auto ready = engine::withMeasuredRange(spec, field, job);
  if (!ready) return tl::unexpected(ready.error());
  spec = *ready;
  const FinishedScans finished(options.resume.resume && options.files.many() && !options.estimate);
  const std::string identity = options.resume.resume
                                   ? engine::identityOf(field, *original, spec, compute.device()).text() +
                                         writingIdentity(field.grid(), options.writing)
                                   : std::string();
  if (auto report = finished.earlier(task.out, identity)) return *std::move(report);
  engine::ExportOptions writing = options.writing;
  writing.original = *original;
  if (auto status = noteSteps(options, typed, task, *imported, writing, job); !status)
    return tl::unexpected(status.error());
  const PlannedWork planned{
      .field = field,
      .original = *original,
      .steps = {PlannedFilter{spec, compute}},
      .out = task.out,
      .extension = isStream(task.out) ? withDot(task.to) : engine::extensionOf(task.out),
      .writing = writing,
      .kept = options.resume.resume};
  // A result that stays in memory is written nowhere, and nothing of it is kept.
  engine::Result<Foreseen> foreseen;
  if (memoryPlace(task.out) == nullptr)
    foreseen = foresee(planned, shownOutput(task.out), options.estimate, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  const std::optional<WorkEstimate>& estimate = foreseen->estimate;
  auto kept = openKeptWork(options.resume, task.out, field, *original, spec, compute.device());
  if (!kept) return tl::unexpected(kept.error());
  const engine::Stopwatch watch;
  const auto filtered = compute.apply(field, *original, spec, job, kept->get());
  const double seconds = watch.seconds();
  if (!filtered) return tl::unexpected(continued(filtered.error(), task.out, *std::move(kept)));
  const engine::Stopwatch save_watch;
  warnOfFilledLost(filtered->field, writing.original, task.out, task.to);
  if (auto status = saveField(filtered->field, task.out, job, writing, task.to); !status)
    return tl::unexpected(continued(status.error(), task.out, *std::move(kept)));
  if (!options.residual.empty()) {
    const auto residual = engine::deviationField(filtered->field, field, job);
    if (!residual) return tl::unexpected(continued(residual.error(), task.out, *std::move(kept)));
    if (auto status = saveField(*residual, options.residual, job); !status)
      return tl::unexpected(continued(status.error(), task.out, *std::move(kept)));
  }
  const double write_seconds = save_watch.seconds();
  if (*kept) (*kept)->finish();

  const double samples = static_cast<double>(field.grid().samples()) * spec.passes;
  const engine::Filter& filter = engine::filterOf(spec.kind);
  Report report{{"filter", options.filter}};
  if (filter.window.exists()) report["window"] = spec.window;
  if (filter.sigma.exists()) report["sigma"] = spec.sigma;
  if (filter.nesting.exists()) report[std::string(filter.nesting_word)] = spec.nesting_mm;
  if (filter.has_element) report["element"] = options.element;
  if (filter.range_sigma.exists()) report["range_sigma"] = spec.range_sigma;
  if (const engine::EdgeLines& lines = field.lines(); lines != nullptr) {
    if (!filter.knows_lines)
      warn(fmt::format("{}: {} knows no edge lines, and smooths over those of the session",
                       shownInput(task.in), filter.word));
    report["lines"] = filter.knows_lines ? lines->size() : 0;
    report["line_points"] = filter.knows_lines ? engine::countPoints(*lines) : 0;
  }
  report["compute"] = compute.device().empty() ? "cpu" : "gpu";
  if (!compute.device().empty()) report["device"] = compute.device();
  report.update({{"passes", spec.passes},
                 {"unit", field.grid().height_unit.name},
                 {"changed", filtered->report.changed},
                 {"max_change", filtered->report.max_change},
                 {"rms_change", filtered->report.rms_change}});
  addWeightless(report, filter, filtered->report, shownInput(task.in));
  if (auto status = addUnjudged(report, field, spec, shownInput(task.in), job); !status)
    return tl::unexpected(status.error());
  warnOfCutoff(spec, field.grid(), shownInput(task.in));
  warnOfBroughtBack(spec, filtered->report, field.grid(), shownInput(task.in));
  report.update(
      {{"seconds", seconds}, {"samples_per_second", samples / seconds}, {"hash", hashOf(filtered->field)}});
  if (!options.residual.empty()) report["residual"] = options.residual;
  addKept(report, kept->get(), spec.passes);
  if (estimate) {
    report["write_seconds"] = write_seconds;
    report["peak_memory_bytes"] = engine::residentMemory().peak;
    std::error_code unknown;
    const auto bytes = isStream(task.out) ? 0 : std::filesystem::file_size(task.out, unknown);
    report["disk_bytes"] = unknown ? 0 : bytes;
    report["estimate"] = reportOf(*estimate);
  }
  finished.add(task.out, identity, report);
  return report;
}

// What a band of one scan is told; options that are of a whole scan are refused.
engine::Result<BandWork> bandWorkOf(const FilterArguments& options) {
  const auto refused = [](const char* option, const char* why) {
    return engine::inputError(fmt::format("{} is not divided into shards", option), option, why);
  };
  if (options.suggest) return refused("--suggest", "pieces of the scan are enough for it: leave shards out");
  if (options.filter.empty()) return engine::inputError("no filter is named", "--filter", "give one");
  if (options.places != 0 || !options.tolerance.empty() || options.budget)
    return refused("--suggest", "leave --places, --tolerance and --budget out");
  if (options.files.many())
    return refused("--out-dir", "a list is shared out without a plan: --out-dir DIR --shard K/N");
  if (options.files.files.size() != 2)
    return engine::inputError("one scan is divided into bands", "IN OUT", "give a scan and a file to write");
  if (!options.residual.empty())
    return refused("--residual", "give IN, OUT and less of it by fettle compare --deviation");
  if (options.resume.resume) return refused("--resume", "a shard is not done twice anyway: leave it out");
  if (options.estimate) return refused("--estimate", "fettle plan says what a shard will take");
  if (options.compute == "gpu")
    return refused("--compute gpu", "machines may differ in it, and results with it: leave it out");
  const auto spec = specOf(options);
  if (!spec) return tl::unexpected(spec.error());
  const std::string& out = options.files.files[1];
  if (auto status = checkOriginal(options.original, !options.max_change.empty(), out); !status)
    return tl::unexpected(status.error());
  const std::vector<BatchTask> task{{options.files.files[0], out, options.files.extension}};
  if (auto status = checkCompress(options.writing, task); !status) return tl::unexpected(status.error());
  return BandWork{.command = "filter",
                  .spec = *spec,
                  .range_sigma = options.range_sigma,
                  .max_change = options.max_change,
                  .keep = options.keep,
                  .only = options.only,
                  .lines = options.lines,
                  .original = options.original,
                  .reading = options.reading,
                  .writing = options.writing,
                  .in = options.files.files[0],
                  .out = out};
}

engine::Result<Report> filterAll(const FilterArguments& options, const std::vector<std::string>& arguments,
                                 engine::JobControl& job) {
  if (options.suggest) return suggestFilters(options, arguments, job);
  if (options.filter.empty())
    return engine::inputError("no filter is named", "--filter", "give one, or use --suggest");
  if (options.places != 0) return engine::inputError("places are for --suggest", "--places", "add --suggest");
  if (!options.tolerance.empty() || options.budget)
    return engine::inputError("tolerance and budget are for --suggest",
                              options.tolerance.empty() ? "--budget" : "--tolerance", "add --suggest");
  const auto spec = specOf(options);
  if (!spec) return tl::unexpected(spec.error());
  const auto tasks =
      batchTasks(options.files, {options.keep, options.only, options.lines, options.original}, job);
  if (!tasks) return tl::unexpected(tasks.error());
  for (const BatchTask& task : *tasks)
    if (auto status = checkOriginal(options.original, !options.max_change.empty(), task.out); !status)
      return tl::unexpected(status.error());
  if (!options.residual.empty()) {
    if (options.files.many() || isStream(options.residual))
      return engine::inputError(
          "a residual is written of one scan, to a file", "--residual",
          "leave it out, and give IN, OUT and less of it by fettle compare --deviation");
    if (auto status = checkOutputs({{options.residual, OutputKind::kField, {}}},
                                   {tasks->front().in, tasks->front().out, options.keep, options.only,
                                    options.lines, options.original},
                                   Replacing::kNoWork, job);
        !status)
      return tl::unexpected(status.error());
  }
  if (auto status = checkCompress(options.writing, *tasks); !status) return tl::unexpected(status.error());
  if (auto status = checkResume(options.resume, *tasks); !status) return tl::unexpected(status.error());
  auto compute = chooseCompute(options.compute, engine::filterOf(spec->kind));
  if (!compute) return tl::unexpected(compute.error());
  const auto one = [&](const BatchTask& task, engine::JobControl& j) {
    auto done = filterOne(options, *spec, *compute, task, j);
    if (!done && !options.estimate)
      return engine::Result<Report>(tl::unexpected(stillKept(done.error(), options.resume, task.out)));
    return done;
  };
  if (options.files.many()) {
    const auto mine = ListShard::begin(*tasks, options.shards.shard, options.reportFolder(), arguments);
    if (!mine) return tl::unexpected(mine.error());
    auto report = runBatch(mine->tasks(), job, one);
    if (report && !options.estimate) FinishedScans(options.resume.resume).end(mine->tasks(), *report);
    if (report)
      if (auto status = mine->keep(*report); !status) return tl::unexpected(status.error());
    return report;
  }
  const ProgressLine progress(job);
  return one(tasks->front(), job);
}

engine::Result<Report> filter(const FilterArguments& options, const std::vector<std::string>& arguments,
                              engine::JobControl& job) {
  if (auto status = checkShardOptions(options.shards); !status) return tl::unexpected(status.error());
  if (options.shards.in_turn || (!options.shards.shard.empty() && !options.files.many())) {
    const auto work = bandWorkOf(options);
    if (!work) return tl::unexpected(work.error());
    const ProgressLine progress(job);
    return options.shards.in_turn ? runBandsInTurn(*work, options.shards, arguments, job)
                                  : runBand(*work, options.shards.shard, job);
  }
  return filterAll(options, arguments, job);
}

}  // namespace

void printFilter(const Report& report) {
  if (report.contains("text")) return printBatch(report);
  if (report.contains("files") && std::ranges::any_of(report["files"], isSuggestion)) {
    for (const Report& file : report["files"]) {
      fmt::print("{}{}\n", file["in"].get<std::string>(), file.contains("error") ? "  failed\n" : "");
      if (file.contains("error")) continue;
      printFilter(file);
      fmt::print("\n");
    }
    fmt::print("{} done, {} failed\n", report["done"].get<std::size_t>(),
               report["failed"].get<std::size_t>());
    return;
  }
  isSuggestion(report) ? printSuggestion(report) : printBatch(report);
}

namespace {

void addFilterRows(Command command, const std::shared_ptr<FilterArguments>& options) {
  addBatchOptions(command, options->files);
  std::vector<Word> filters;
  std::vector<std::string> sigmas, ranges;
  for (const engine::Filter& filter : engine::filters()) {
    filters.emplace_back(std::string(filter.word), std::string(filter.says));
    if (filter.sigma.exists()) sigmas.push_back(fmt::format("{} ({})", filter.sigma.when_zero, filter.word));
    if (filter.range_sigma.exists()) ranges.push_back(fmt::format("{:g} ({})", filter.noises, filter.word));
  }
  command.add({
      {.name = "--filter",
       .to = &options->filter,
       .text = fmt::format("The filter; {} keep edges", engine::filterWords(engine::keepsEdges)),
       .words = filters},
      {.name = "--window",
       .to = &options->window,
       .text = "Side of the window, odd",
       .range = Range{1.0, engine::FilterSpec::kMaxWindow},
       .unit = "samples"},
      {.name = "--sigma",
       .to = &options->sigma,
       .text = "Standard deviation of the weights",
       .unit = "samples",
       .otherwise = fmt::format("{}", fmt::join(sigmas, ", "))},
      {.name = "--range-sigma",
       .to = &options->range_sigma,
       .text = "How large a difference is noise",
       .kind = ValueKind::kLength,
       .otherwise =
           fmt::format("{} standard deviations of noise_finest of fettle info", fmt::join(ranges, ", "))},
      {.name = "--cutoff",
       .to = &options->cutoff,
       .text = fmt::format("Wavelength of which half stays; shorter ones are removed ({})",
                           engine::filterWords(nestingOptions(*options)[0].has, ", ")),
       .kind = ValueKind::kLength,
       .unit = "mm",
       .shown = "MM"},
      {.name = "--radius",
       .to = &options->radius,
       .text =
           fmt::format("Of the ball or disk that is rolled along the surface; half of a square's side ({})",
                       engine::filterWords(nestingOptions(*options)[1].has, ", ")),
       .kind = ValueKind::kLength,
       .unit = "mm",
       .shown = "MM"},
      {.name = "--element",
       .to = &options->element,
       .text = fmt::format("What is rolled along it; disk and square are horizontal ({})",
                           engine::filterWords(engine::hasElement, ", ")),
       .words = {{"ball", ""}, {"disk", ""}, {"square", ""}}},
      {.name = "--passes",
       .to = &options->passes,
       .text = "Times that the filter is applied to its own result",
       .range = Range{1.0, engine::FilterSpec::kMaxPasses}},
      {.name = "--keep",
       .to = &options->keep,
       .text = "Picture of marks: these samples are not changed",
       .kind = ValueKind::kMarks},
      {.name = "--only",
       .to = &options->only,
       .text = "Picture of marks: only these samples are filtered",
       .kind = ValueKind::kMarks,
       .excludes = {"--keep"}},
      {.name = "--lines",
       .to = &options->lines,
       .text = fmt::format(
           "Edge lines, .csv, .geojson, .gpkg or .dxf: {} keep the two sides of a step apart there",
           engine::filterWords(engine::knowsLines)),
       .kind = ValueKind::kLines},
      {.name = "--residual",
       .to = &options->residual,
       .text =
           "Also write what is taken away, IN less OUT, as a separate scan: the roughness beside a waviness",
       .kind = ValueKind::kOutput},
      {.name = "--max-change",
       .to = &options->max_change,
       .text =
           "Limit of change: no sample ends farther than this from the original, whatever steps came before. "
           "The original is the scan that a session began with, else --original, else IN",
       .kind = ValueKind::kLength},
  });
  addOriginalOption(command, options->original);
  command.add({{.name = "--threads",
                .to = &options->threads,
                .text = "Threads to use",
                .range = Range{0.0, engine::FilterSpec::kMaxThreads},
                .otherwise = "0, one per core"}});
  addComputeOption(command, options->compute);
  command.add(
      {
          {.name = "--suggest",
           .to = &options->suggest,
           .text = "Filter nothing: test filters on pieces of IN, print which one to use for --tolerance, "
                   "why, and the command for it; with --out-dir for each scan"},
          {.name = "--tolerance",
           .to = &options->tolerance,
           .text = "Allowed root mean square error on flats and near edges, each separately",
           .kind = ValueKind::kLength},
          {.name = "--budget",
           .to = &options->budget,
           .text = "Longest time for filtering the scan",
           .unit = "seconds"},
          {.name = "--places",
           .to = &options->places,
           .text = "Name this many places where an edge line drawn by hand would gain tgv most; without "
                   "--tolerance only these",
           .range = Range{1.0, 1000.0},
           .otherwise = "none"},
      },
      "Suggesting a filter");
  addCompressOption(command, options->writing);
  addScanOptions(command, options->reading);
}

}  // namespace

void addFilter(Command root, Chosen& chosen) {
  auto options = std::make_shared<FilterArguments>();
  Command command = addCommand(
      root, chosen, "filter", "Filter whole scans, except marked samples",
      [options, &chosen](engine::JobControl& job) { return filter(*options, chosen.arguments, job); },
      printFilter, Progress::kOwn, batchStatus);
  addFilterRows(command, options);
  addEstimateOption(command, options->estimate);
  addResumeOptions(command, options->resume);
  addShardOptions(command, options->shards);
  command.examples(
      {{"fettle filter scan.tif clean.tif --filter tgv", "The best without a hand"},
       {"fettle filter scan.tif clean.tif --filter median --window 5 --keep marks.png --max-change 50um",
        "A median that leaves marked samples as they are, and no sample farther than that from the scan"},
       {"fettle filter scan.tif waviness.tif --filter areal-gaussian --cutoff 0.8 --residual roughness.tif",
        "Waviness and roughness by a cut-off of 0.8 mm (ISO 16610-61)"},
       {"fettle filter scan.tif clean.tif --filter closing --radius 0.5",
        "What a ball of 0.5 mm touches from above: pits and grooves narrower than it are filled"},
       {"fettle filter scan.tif --suggest --tolerance 12um", "Which filter is good enough, and why"}});
}

void addPlanFilter(Command plan, Chosen& chosen) {
  auto options = std::make_shared<FilterArguments>();
  auto shards = std::make_shared<PlanOptions>();
  Command command = addCommand(
      plan, chosen, "filter", "Plan filtering one scan in shards",
      [options, shards, &chosen](engine::JobControl& job) -> engine::Result<Report> {
        const auto work = bandWorkOf(*options);
        if (!work) return tl::unexpected(work.error());
        const auto planned = planBands(*work, *shards, shardArguments(chosen.arguments), {}, job);
        if (!planned) return tl::unexpected(planned.error());
        return reportOf(*planned);
      },
      printPlan);
  addPlanOptions(command, *shards);
  addFilterRows(command, options);
  command.examples({{"fettle plan filter scan.tif planned.tif --filter tgv --shards 2",
                     "Finds the noise, and makes the file that two shards write to"}});
}

}  // namespace fettle::app
