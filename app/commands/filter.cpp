#include <algorithm>
#include <array>
#include <cmath>
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
#include "app/commands/finished_scans.h"
#include "app/commands/known_steps.h"
#include "app/commands/list_text.h"
#include "app/commands/original_scan.h"
#include "app/commands/output_checks.h"
#include "app/commands/place_report.h"
#include "app/commands/resume_option.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/shards/band_work.h"
#include "app/commands/shards/list_shard.h"
#include "app/commands/shards/plan.h"
#include "app/commands/shell_word.h"
#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/streams.h"
#include "engine/base/lower_case.h"
#include "engine/base/memory.h"
#include "engine/base/stopwatch.h"
#include "engine/compare/compare.h"
#include "engine/field/piece.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/noise_range.h"
#include "engine/suggest/filter_suggestion.h"

namespace fettle::app {

namespace {

struct FilterArguments {
  BatchOptions files;
  std::string filter;
  int window = 3;
  double sigma = 0.0;
  std::string range_sigma;
  std::string cutoff, radius;  // nesting indices
  std::string element = "ball";
  std::string residual;
  int passes = 1;
  std::string keep;
  std::string only;
  std::string lines;
  std::string max_change;
  std::string original;
  int threads = 0;
  std::string compute = "auto";
  bool suggest = false;
  std::string tolerance;
  std::optional<double> budget;
  int places = 0;
  ResumeOptions resume;
  bool estimate = false;
  ShardOptions shards;
  ScanOptions reading;
  engine::ExportOptions writing;
};

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
                 {"rms_change", filtered->report.rms_change},
                 {"seconds", seconds},
                 {"samples_per_second", samples / seconds},
                 {"hash", hashOf(filtered->field)}});
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

// The command line that runs a candidate.
std::vector<std::string> commandsFor(const FilterArguments& options, const BatchTask& task,
                                     const engine::FilterCandidate& c) {
  if (c.spec.window == 1) return {};
  const std::string in = quotedWord(task.in);
  std::string out = task.out.empty() ? "OUT.tif" : quotedWord(task.out);
  if (options.files.many()) {  // the folder may have to be created
    out = "--out-dir " + quotedWord(options.files.out_dir);
    if (!options.files.extension.empty()) out += " --to " + quotedWord(options.files.extension);
  }
  // Of several scans each has marks of its own.
  const std::string marks = options.files.many() ? task.in + ".marks.png" : "marks.png";
  const std::string reading = scanOptionsText(options.reading);
  std::vector<std::string> commands;
  std::string filter = fmt::format("fettle filter {} {} --filter {}", in, out, engine::name(c.spec.kind));
  if (engine::filterOf(c.spec.kind).window.exists()) filter += fmt::format(" --window {}", c.spec.window);
  if (c.spec.passes > 1) filter += fmt::format(" --passes {}", c.spec.passes);
  if (engine::hasRange(c.spec.kind)) filter += fmt::format(" --range-sigma {}", c.spec.range_sigma);
  std::string keep = options.keep;
  if (c.around_edges) {
    commands.push_back(fmt::format("fettle mark {} {} --edges --thickness {}{}{}", in, quotedWord(marks),
                                   c.thickness, keep.empty() ? "" : " --add " + quotedWord(keep), reading));
    keep = marks;
  }
  if (!keep.empty()) filter += " --keep " + quotedWord(keep);
  if (options.threads != 0) filter += fmt::format(" --threads {}", options.threads);
  commands.push_back(filter + reading);
  return commands;
}

// "7.1 um on flats and 12 um near edges".
std::string leftBy(const engine::FilterCandidate& c, const std::string& unit) {
  const auto part = [&](double error, const char* where) {
    return std::isnan(error) ? std::string() : fmt::format("{:.3g} {} {}", error, unit, where);
  };
  const std::string flat = part(c.error_flat, "on flats"), edge = part(c.error_edge, "near edges");
  return flat.empty() || edge.empty() ? flat + edge : flat + " and " + edge;
}

// Whatever time it takes; null: none is.
const engine::FilterCandidate* cheapestWithin(const engine::FilterSuggestion& found, double tolerance) {
  const engine::FilterCandidate* cheapest = nullptr;
  for (const engine::FilterCandidate& c : found.candidates)
    if (c.error() <= tolerance && (cheapest == nullptr || c.betterThan(*cheapest))) cheapest = &c;
  return cheapest;
}

// The reason for the choice, from the figures.
std::string whyOf(const engine::FilterSuggestion& found, const engine::SuggestionRequest& asked,
                  const std::string& unit) {
  const engine::FilterCandidate& pick = found.picked();
  const auto affordable = [&](const engine::FilterCandidate& c) {
    return !asked.budget_s || c.seconds <= *asked.budget_s;
  };
  const engine::FilterCandidate *marked = nullptr, *flattest = nullptr;
  for (const engine::FilterCandidate& c : found.candidates) {
    if (!affordable(c)) continue;
    if (c.around_edges && (marked == nullptr || c.error() < marked->error())) marked = &c;
    if (flattest == nullptr || c.error_flat < flattest->error_flat) flattest = &c;
  }
  std::string why = fmt::format("The noise is {:.3g} {}. ", found.sigma, unit);
  if (pick.spec.window == 1 && found.met())
    return why + fmt::format("The unchanged scan stays within {:.3g} {}: no filter is needed.",
                             asked.tolerance, unit);
  if (found.met()) {
    why += fmt::format(
        "{} leaves {}, in about {:.2g} s; of all tested filters that stay within {:.3g} {}, none needs less "
        "computing.",
        engine::methodOf(pick), leftBy(pick, unit), pick.seconds, asked.tolerance, unit);
  } else {
    why +=
        fmt::format("No tested filter stays within {:.3g} {}{}. Nearest is {} with {}, in about {:.2g} s.",
                    asked.tolerance, unit, asked.budget_s ? fmt::format(" in {:g} s", *asked.budget_s) : "",
                    engine::methodOf(pick), leftBy(pick, unit), pick.seconds);
    const engine::FilterCandidate* slow = cheapestWithin(found, asked.tolerance);
    if (slow != nullptr)
      why += fmt::format(" {} does, in about {:.2g} s: give a larger --budget.", engine::methodOf(*slow),
                         slow->seconds);
    else if (flattest != nullptr && flattest->error_flat <= asked.tolerance)
      why += fmt::format(
          " Only flats: {} leaves {}; edges that need a smaller error must be "
          "smoothed with the stylus (fettle view) or scanned again.",
          engine::methodOf(*flattest), leftBy(*flattest, unit));
    else
      why += " A scan with less noise is needed, or the mean of several.";
  }
  if (marked != nullptr && !pick.around_edges)
    why += fmt::format(" Marking edges first leaves {} ({}): marked samples keep their noise.",
                       leftBy(*marked, unit), engine::methodOf(*marked));
  if (found.outlier_share > 1e-4)
    why +=
        fmt::format(" {:.2g} % of the samples are single outliers: a median removes most of these, {} none.",
                    100.0 * found.outlier_share, engine::filterWords(engine::keepsEdges));
  return why;
}

Report reportOf(const engine::FilterCandidate& c) {
  const auto figure = [](double value) { return std::isnan(value) ? Report() : Report(value); };
  return {{"method", engine::methodOf(c)},
          {"filter", c.spec.window == 1 ? Report() : Report(engine::name(c.spec.kind))},
          {"window", c.spec.window},
          {"passes", c.spec.passes},
          {"range_sigma", engine::hasRange(c.spec.kind) ? Report(c.spec.range_sigma) : Report()},
          {"around_edges", c.around_edges},
          {"thickness", c.around_edges ? Report(c.thickness) : Report()},
          {"error_flat", figure(c.error_flat)},
          {"error_edge", figure(c.error_edge)},
          {"seconds", c.seconds},
          {"within", c.within}};
}

// Refuses what --suggest has no use for.
engine::Status checkSuggest(const FilterArguments& options) {
  const auto refused = [](const char* option, const char* why) {
    return engine::inputError(fmt::format("--suggest cannot be used with {}", option), option, why);
  };
  if (!options.files.many() && options.files.files.size() > 2)
    return refused("several scans",
                   "give one scan and optionally OUT, or several with --out-dir, which are only named");
  if (!options.filter.empty()) return refused("--filter", "the filter is what is suggested");
  if (!options.only.empty()) return refused("--only", "give --keep, or nothing");
  if (options.resume.resume) return refused("--resume", "nothing is filtered that could be kept");
  if (!options.original.empty()) return refused("--original", "its filters have no limit of change");
  if (!options.lines.empty()) return refused("--lines", "its filters are tried without edge lines");
  const std::pair<bool, const char*> numbers[] = {
      {options.window != 3, "--window"},        {options.sigma != 0.0, "--sigma"},
      {options.passes != 1, "--passes"},        {!options.range_sigma.empty(), "--range-sigma"},
      {!options.cutoff.empty(), "--cutoff"},    {!options.radius.empty(), "--radius"},
      {options.element != "ball", "--element"}, {!options.residual.empty(), "--residual"}};
  for (const auto& [given, option] : numbers)
    if (given) return refused(option, "the numbers of the filter are suggested with it");
  if (!options.max_change.empty())
    return refused("--max-change", "its filters have no limit of change: add one to the command it names");
  const bool filters = !options.tolerance.empty() || options.places == 0;
  if (filters && options.tolerance.empty())
    return engine::inputError("no tolerance is given", "--tolerance",
                              "give the allowed error, as 0.01 in the scan's unit or 10um");
  if (!filters && options.budget)
    return refused("--budget", "give --tolerance: without it only places are named");
  if (!filters && !options.files.many() && options.files.files.size() > 1)
    return refused("OUT", "give --tolerance: without it only places are named, and no command for OUT");
  if (options.compute == "gpu")
    return refused("--compute gpu",
                   "leave it out: filters are tried, and their time measured, on the processor");
  return {};
}

// Of one scan; `out` is named in the commands, and empty where none is known.
engine::Result<Report> suggestOne(const FilterArguments& options, const BatchTask& task,
                                  engine::JobControl& job) {
  const bool filters = !options.tolerance.empty() || options.places == 0;
  auto imported = loadScan(task.in, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  auto marked = withMarks(imported->field, options.keep, job);
  if (!marked) return tl::unexpected(marked.error());
  const engine::Version field = *std::move(marked);
  const auto tolerance = parseHeight(filters ? options.tolerance : "1", field.grid(), "--tolerance");
  if (!tolerance) return tl::unexpected(tolerance.error());
  Report report = Report::object();
  if (options.places > 0) {
    auto places = placeReport(field, options.places, options.threads, job);
    if (!places) return tl::unexpected(places.error());
    report = *std::move(places);
    if (!filters) return report;
  }
  engine::SuggestionRequest request;
  request.tolerance = *tolerance;
  request.budget_s = options.budget;
  request.threads = options.threads;
  // A suggestion is tried on pieces of so many samples at most.
  PlannedOnPieces trying{[&](const engine::SampleRect& rect, engine::JobControl& own) {
                           const engine::Version piece =
                               engine::pieceOf(field, rect.column, rect.row, rect.columns, rect.rows);
                           auto tried = engine::suggestFilter(piece, request, own);
                           return tried ? engine::Result<engine::Version>(piece)
                                        : engine::Result<engine::Version>(tl::unexpected(tried.error()));
                         },
                         1, engine::kMostSuggestionSamples};
  // Measured on scans of 1200 and 3000 samples a side; squares as small as an estimate tries show half of it.
  trying.memory_each = 105.0;
  const PlannedWork planned{
      .field = field, .original = field, .steps = {trying}, .out = {}, .extension = {}, .writing = {}};
  auto foreseen = foresee(planned, shownInput(task.in), options.estimate, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  const auto found = engine::suggestFilter(field, request, job);
  if (!found) return tl::unexpected(found.error());
  const std::string& unit = field.grid().height_unit.name;
  report.update({{"met", found->met()},
                 {"why", whyOf(*found, request, unit)},
                 {"commands", commandsFor(options, task, found->picked())},
                 {"unit", unit},
                 {"tolerance", request.tolerance},
                 {"budget", request.budget_s ? Report(*request.budget_s) : Report()},
                 {"noise", found->sigma},
                 {"samples", found->samples},
                 {"outlier_share", found->outlier_share},
                 {"edge_share", found->edge_share},
                 {"pick", reportOf(found->picked())}});
  report["candidates"] = Report::array();
  for (const engine::FilterCandidate& c : found->candidates) report["candidates"].push_back(reportOf(c));
  return report;
}

// The part of a list that this process does; of an estimate no report is kept.
engine::Result<ListShard> shardOf(const FilterArguments& options, const std::vector<BatchTask>& tasks,
                                  const std::vector<std::string>& arguments) {
  return ListShard::begin(tasks, options.shards.shard,
                          options.estimate ? std::string() : options.files.out_dir, arguments);
}

engine::Result<Report> suggest(const FilterArguments& options, const std::vector<std::string>& arguments,
                               engine::JobControl& job) {
  if (auto status = checkSuggest(options); !status) return tl::unexpected(status.error());
  if (!options.files.many()) {
    const ProgressLine progress(job);
    const std::vector<std::string>& files = options.files.files;
    return suggestOne(options, {files[0], files.size() > 1 ? files[1] : std::string(), {}}, job);
  }
  auto tasks = namedTasks(options.files);
  if (!tasks) return tl::unexpected(tasks.error());
  // Outputs are named and not written.
  for (BatchTask& task : *tasks) task.out.clear();
  const auto mine = shardOf(options, *tasks, arguments);
  if (!mine) return tl::unexpected(mine.error());
  auto report = runBatch(mine->tasks(), job, [&](const BatchTask& task, engine::JobControl& j) {
    return suggestOne(options, task, j);
  });
  if (report)
    if (auto status = mine->keep(*report); !status) return tl::unexpected(status.error());
  return report;
}

void printSuggestion(const Report& report) {
  fmt::print("{}\n", report["why"].get<std::string>());
  for (const Report& command : report["commands"]) fmt::print("\n    {}", command.get<std::string>());
  const std::string unit = report["unit"];
  fmt::print("\n\n{:<48}{:>14}{:>14}{:>10}\n", "expected", "flats, " + unit, "edges, " + unit, "s");
  const auto figure = [](const Report& value) {
    return value.is_null() ? std::string("-") : fmt::format("{:.3g}", value.get<double>());
  };
  for (const Report& c : report["candidates"])
    fmt::print("{:<48}{:>14}{:>14}{:>10}{}\n", c["method"].get<std::string>(), figure(c["error_flat"]),
               figure(c["error_edge"]), figure(c["seconds"]), c["within"].get<bool>() ? "  within" : "");
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
  if (options.suggest) return suggest(options, arguments, job);
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
    const auto mine = shardOf(options, *tasks, arguments);
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

bool isSuggestion(const Report& report) {
  return report.contains("commands") || report.contains("places");
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
  const bool suggested = report.contains("commands"), places = report.contains("places");
  if (suggested) printSuggestion(report);
  if (suggested && places) fmt::print("\n");
  if (places) printPlaces(report);
  if (!suggested && !places) printBatch(report);
}

namespace {

void addFilterRows(Command command, const std::shared_ptr<FilterArguments>& options) {
  addBatchOptions(command, options->files);
  std::vector<Word> filters;
  std::vector<std::string> sigmas, ranges;
  for (const engine::Filter& filter : engine::filters()) {
    filters.emplace_back(std::string(filter.word),
                         engine::lowerCase(filter.title) == filter.word ? "" : std::string(filter.title));
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
       .text = "Largest change of a sample from the original: that of a session, else --original, else IN",
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
