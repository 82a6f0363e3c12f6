#include "app/commands/filter_suggestion.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "app/commands/estimate_option.h"
#include "app/commands/place_report.h"
#include "app/commands/scan_files.h"
#include "app/commands/shards/list_shard.h"
#include "app/commands/shell_word.h"
#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "app/work/streams.h"
#include "app/work/suggestion_text.h"
#include "engine/field/piece.h"
#include "engine/filter/catalogue.h"
#include "engine/suggest/filter_suggestion.h"

namespace fettle::app {

namespace {

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

// In the scan's own unit, with the words of the command line.
SuggestionWords wordsOf(const engine::Version& field) {
  return {{field.grid().height_unit.name}, engine::methodOf};
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
          {"within", c.within},
          {"why", Report()}};
}

// All that were tried, the listed ones with what they are listed for.
Report candidatesOf(const engine::FilterSuggestion& found, const std::vector<ListedFilter>& listed) {
  Report all = Report::array();
  for (const engine::FilterCandidate& c : found.candidates) all.push_back(reportOf(c));
  for (const ListedFilter& each : listed) all[each.candidate]["why"] = each.why;
  return all;
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
  const SuggestionWords words = wordsOf(field);
  const Report candidates = candidatesOf(*found, listedFilters(*found, request, words.unit));
  report.update({{"met", found->met()},
                 {"why", reasonText(*found, request, words)},
                 {"commands", commandsFor(options, task, found->picked())},
                 {"unit", words.unit.name},
                 {"tolerance", request.tolerance},
                 {"budget", request.budget_s ? Report(*request.budget_s) : Report()},
                 {"noise", found->sigma},
                 {"samples", found->samples},
                 {"outlier_share", found->outlier_share},
                 {"edge_share", found->edge_share},
                 {"pick", candidates[found->pick]},
                 {"candidates", candidates}});
  return report;
}

void printFilters(const Report& report) {
  fmt::print("{}\n", report["why"].get<std::string>());
  for (const Report& command : report["commands"]) fmt::print("\n    {}", command.get<std::string>());
  const std::string unit = report["unit"];
  fmt::print("\n\n{:<48}{:>14}{:>14}{:>10}\n", "expected", "flats, " + unit, "edges, " + unit, "s");
  const auto figure = [](const Report& value) {
    return value.is_null() ? std::string("-") : fmt::format("{:.3g}", value.get<double>());
  };
  for (const Report& c : report["candidates"])
    fmt::print("{:<48}{:>14}{:>14}{:>10}{}{}\n", c["method"].get<std::string>(), figure(c["error_flat"]),
               figure(c["error_edge"]), figure(c["seconds"]), c["within"].get<bool>() ? "  within" : "",
               c["why"].is_null() ? "" : "  " + c["why"].get<std::string>());
}

}  // namespace

engine::Result<Report> suggestFilters(const FilterArguments& options,
                                      const std::vector<std::string>& arguments, engine::JobControl& job) {
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
  const auto mine = ListShard::begin(*tasks, options.shards.shard, options.reportFolder(), arguments);
  if (!mine) return tl::unexpected(mine.error());
  auto report = runBatch(mine->tasks(), job, [&](const BatchTask& task, engine::JobControl& j) {
    return suggestOne(options, task, j);
  });
  if (report)
    if (auto status = mine->keep(*report); !status) return tl::unexpected(status.error());
  return report;
}

bool isSuggestion(const Report& report) {
  return report.contains("commands") || report.contains("places");
}

void printSuggestion(const Report& report) {
  const bool filters = report.contains("commands"), places = report.contains("places");
  if (filters) printFilters(report);
  if (filters && places) fmt::print("\n");
  if (places) printPlaces(report);
}

}  // namespace fettle::app
