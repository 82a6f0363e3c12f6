#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/align_estimate.h"
#include "app/commands/align_option.h"
#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/compare_nominal.h"
#include "app/commands/estimate_option.h"
#include "app/commands/list_text.h"
#include "app/commands/output_checks.h"
#include "app/commands/region_option.h"
#include "app/commands/rounding_warning.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/shards/list_shard.h"
#include "app/commands/shards/shard_option.h"
#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/outputs.h"
#include "app/work/streams.h"
#include "engine/compare/compare.h"
#include "engine/field/piece.h"
#include "engine/formats/formats.h"
#include "engine/measure/moved_onto.h"

namespace fettle::app {

namespace {

// --region is that of the figures.
AlignArguments alignedApart() {
  AlignArguments align;
  align.region.clear();
  align.option = "--align-region";
  align.marks_option = "--align-marks";
  return align;
}

struct CompareArguments {
  std::string a;
  std::vector<std::string> others;
  std::string b;  // the one of them that A is compared with
  std::string truth;
  std::string edges;
  std::string deviation;
  Replacing replacing = Replacing::kNoWork;
  std::string to;
  bool estimate = false;
  bool aligned = false;  // B is moved onto A first
  RegionArguments counted;
  AlignArguments align = alignedApart();
  InspectArguments inspect;
  std::string shard, shard_folder;
  ScanOptions reading;
};

// Fields are compared sample by sample; a warning states if their position or spacing differs.
void warnOfDifferentGrids(const CompareArguments& options, const engine::Grid& a, const engine::Grid& b) {
  const std::string both = shownInput(options.a) + " and " + shownInput(options.b);
  if (a.spacingXMm() != b.spacingXMm() || a.spacingYMm() != b.spacingYMm())
    warn(both + " have different spacings and are compared sample by sample");
  if (a.origin_x * a.lateral_unit.mm != b.origin_x * b.lateral_unit.mm ||
      a.origin_y * a.lateral_unit.mm != b.origin_y * b.lateral_unit.mm)
    warn(both + " are at different positions and are compared sample by sample");
  if (!(a.height_unit == b.height_unit))
    warn(fmt::format(
        "heights are in {} and {}: the second are converted, give --unit where a file states none",
        a.height_unit.name, b.height_unit.name));
}

// Without a place at which both have a height no figure has a value.
engine::Error nothingInCommon(const CompareArguments& options, const engine::Deviation& deviation) {
  const std::string what = deviation.only_a == 0 && deviation.only_b == 0
                               ? std::string("there is nothing to compare, both scans have only holes")
                               : fmt::format(
                                     "there is nothing to compare, no place has a height in both scans: {} "
                                     "in A alone, {} in B alone",
                                     deviation.only_a, deviation.only_b);
  const char* const remedy = options.counted.region != "all" ? "choose another --region"
                             : options.aligned
                                 ? "is B of the same part? fettle info counts the holes"
                                 : "give --align all where B lies elsewhere, or fill holes by fettle fill";
  return {engine::ErrorKind::kInput, what, shownInput(options.a) + " and " + shownInput(options.b), remedy};
}

// Options that say something about an alignment, or that exclude one.
engine::Status checkAligned(const CompareArguments& options) {
  if (!options.aligned) {
    const char* const alone = options.align.rotation          ? "--rotation"
                              : !options.align.region.empty() ? "--align-region"
                              : !options.align.marks.empty()  ? "--align-marks"
                                                              : nullptr;
    return alone == nullptr ? engine::Status()
                            : engine::inputError("nothing is aligned", alone, "give --align all");
  }
  // Before there was a region of figures, --region was that of the alignment.
  if (options.align.region.empty() && options.counted.region != "all")
    return engine::inputError(
        "it is not said by which samples B is aligned: --region is of the figures", "--align",
        fmt::format("add --align-region all, or --align-region \"{}\"", options.counted.region));
  return checkAlign(options.align);
}

// Options that need a nominal mesh, or that it excludes.
engine::Status checkNominal(const CompareArguments& options) {
  if (!isNominal(options.b, options.reading, options.inspect.nominal)) {
    const std::string alone = optionOfNominal(options.inspect);
    return alone.empty() ? engine::Status()
                         : engine::inputError(fmt::format("{} is no nominal mesh", shownInput(options.b)),
                                              alone, "give an .stl as B, or a .ply with --nominal-unit");
  }
  return options.truth.empty()
             ? engine::Status()
             : engine::inputError(fmt::format("{} is a nominal mesh", shownInput(options.b)), "--truth",
                                  "it is for two scans");
}

// Options that contradict each other, whatever is in the files.
engine::Status checkPair(const CompareArguments& options) {
  if (!options.edges.empty() && options.truth.empty())
    return engine::inputError("edges need a truth", "--edges", "give --truth too");
  if (auto status = checkNominal(options); !status) return status;
  if (auto status = checkRegion(options.counted); !status) return status;
  return checkAligned(options);
}

engine::Result<Foreseen> foreseeCompare(const CompareArguments& options, const engine::Version& a,
                                        const engine::Version& b, engine::JobControl& job) {
  const engine::Grid &of_a = a.grid(), &of_b = b.grid();
  // The comparison refuses it.
  if (!options.aligned && (of_a.width != of_b.width || of_a.height != of_b.height)) return Foreseen{};
  const auto pieceAt = [](const engine::Version& of, const engine::SampleRect& r) {
    return engine::pieceOf(of, r.column, r.row, r.columns, r.rows);
  };
  std::vector<PlannedStep> steps;
  if (options.aligned) {
    steps.emplace_back(plannedAlignment(a, b, options.align));
    // As long as of B, whose samples may be others.
    steps.emplace_back(PlannedOnPieces{.work = [&](const engine::SampleRect& r, engine::JobControl& own) {
      const engine::Version piece = pieceAt(a, r);
      return engine::movedOnto(piece, engine::RigidMotion{}, piece.grid(), own);
    }});
  }
  steps.emplace_back(
      PlannedOnPieces{.work =
                          [&](const engine::SampleRect& r, engine::JobControl& own) {
                            const engine::Version first = pieceAt(a, r);
                            const engine::Version second = options.aligned ? first : pieceAt(b, r);
                            const auto compared = engine::compareFields(first, second, own);
                            if (!compared)
                              return engine::Result<engine::Version>(tl::unexpected(compared.error()));
                            return options.deviation.empty() ? engine::Result<engine::Version>(first)
                                                             : engine::deviationField(first, second, own);
                          },
                      .fields = 2});
  const PlannedWork planned{
      .field = a,
      .original = a,
      .steps = std::move(steps),
      .out = memoryPlace(options.deviation) != nullptr ? std::string() : options.deviation,
      .extension = isStream(options.deviation) ? withDot(options.to) : engine::extensionOf(options.deviation),
      .writing = {}};
  return foresee(planned, shownInput(options.b), options.estimate, job);
}

// `first`: A, where it was read before; else it is read into it.
engine::Result<Report> compareOne(const CompareArguments& options, std::optional<engine::Imported>& first,
                                  engine::JobControl& job) {
  if (auto status = checkPair(options); !status) return tl::unexpected(status.error());
  if (auto status = checkOutputs(
          {{options.deviation, OutputKind::kField, options.to}},
          {options.a, options.b, options.truth, options.edges, options.counted.marks, options.align.marks},
          options.replacing, job);
      !status)
    return tl::unexpected(status.error());
  if (isNominal(options.b, options.reading, options.inspect.nominal))
    return compareNominal(
        {options.a, options.b, options.inspect, options.counted, options.aligned ? &options.align : nullptr,
         options.reading, options.deviation, options.to, options.estimate},
        job);
  if (!first) {
    auto read = loadSamples(options.a, options.reading, job);
    if (!read) return tl::unexpected(read.error());
    first = *std::move(read);
  }
  const engine::Imported* const a = &*first;
  auto b = loadSamples(options.b, options.reading, job);
  if (!b) return tl::unexpected(b.error());
  auto foreseen = foreseeCompare(options, a->field, b->field, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  Report alignment;
  if (options.aligned) {
    // Where B was moved, its samples are others than those that were filled.
    warnOfFilled(b->field, b->original, options.b);
    const auto found = alignmentOf(*a, b->field, options.a, options.b, options.align, job);
    if (!found) return tl::unexpected(found.error());
    auto moved = engine::movedOnto(b->field, found->motion, a->field.grid(), job);
    if (!moved) return tl::unexpected(moved.error());
    b->field = *std::move(moved);
    alignment = alignReport(options.align, *found);
  }
  const auto of_a = chosenOf(a->field, a->original, options.a, options.counted, job);
  if (!of_a) return tl::unexpected(of_a.error());
  warnOfFilled(*of_a, a->original, options.a);
  const auto of_b = chosenLike(b->field, *of_a, options.counted, job);
  if (!of_b) return tl::unexpected(of_b.error());
  if (!options.aligned) warnOfFilled(*of_b, b->original, options.b);
  const auto deviation = engine::compareFields(*of_a, *of_b, job);
  if (!deviation) return tl::unexpected(deviation.error());
  warnOfDifferentGrids(options, a->field.grid(), b->field.grid());
  if (deviation->samples == 0) return tl::unexpected(nothingInCommon(options, *deviation));
  warnOfRounding({&a->field, &b->field}, deviation->rms, "the rms of the deviation", shownInput(options.b));
  Report report{{"unit", a->field.grid().height_unit.name},
                {"samples", deviation->samples},
                {"rms", deviation->rms},
                {"mean", deviation->mean},
                {"max_abs", deviation->max_abs},
                {"p99", deviation->p99},
                {"sq", deviation->sq_b},
                {"sa", deviation->sa_b},
                {"sq_a", deviation->sq_a},
                {"sa_a", deviation->sa_a},
                {"only_a", deviation->only_a},
                {"only_b", deviation->only_b}};
  if (options.counted.region != "all") report["region"] = options.counted.region;
  if (options.aligned) report["align"] = std::move(alignment);
  if (!options.deviation.empty()) {
    const auto difference = engine::deviationField(*of_a, *of_b, job);
    if (!difference) return tl::unexpected(difference.error());
    if (auto status = saveField(*difference, options.deviation, job, {}, options.to); !status)
      return tl::unexpected(status.error());
    report["deviation"] = options.deviation;
  }
  if (options.truth.empty()) return report;

  const auto truth = loadSamples(options.truth, options.reading, job);
  if (!truth) return tl::unexpected(truth.error());
  const auto edges = withMarks(truth->field, options.edges, job);
  if (!edges) return tl::unexpected(edges.error());
  const auto figures = engine::compareToTruth(*of_b, truth->field, *edges, job);
  if (!figures) return tl::unexpected(figures.error());
  report["rmse"] = figures->rmse;
  report["rmse_flat"] = figures->rmse_flat;
  report["rmse_edge"] = figures->rmse_edge;
  report["edge_width"] = figures->edge_width;
  return report;
}

// Several: the first is what all others are compared with, or the last, where it is the nominal shape of all before it.
engine::Result<Report> compareAll(const CompareArguments& options, const std::vector<std::string>& arguments,
                                  engine::JobControl& job) {
  std::vector<std::string> scans = options.others;
  const bool of_nominal = isNominal(scans.back(), options.reading, options.inspect.nominal);
  const std::string with = of_nominal ? scans.back() : options.a;
  if (of_nominal) {
    scans.pop_back();
    scans.insert(scans.begin(), options.a);
  }
  if (!options.deviation.empty())
    return engine::inputError("a deviation is written of two scans", "--deviation",
                              "leave it out, or compare one after another");
  if (std::ranges::any_of(scans, isStream))
    return engine::inputError("standard input is one scan", "-", "name files where several are compared");
  std::vector<BatchTask> tasks;
  tasks.reserve(scans.size());
  for (const std::string& scan : scans) tasks.push_back({scan, {}, {}});
  const auto pairOf = [&](const std::string& scan) {
    CompareArguments pair = options;
    pair.a = of_nominal ? scan : with;
    pair.b = of_nominal ? with : scan;
    return pair;
  };
  // What would refuse every scan is no failure of each of them.
  if (auto status = checkPair(pairOf(scans.front())); !status) return tl::unexpected(status.error());
  std::optional<engine::Imported> first;
  if (!of_nominal) {
    const ProgressLine progress(job);
    auto read = loadSamples(with, options.reading, job);
    if (!read) return tl::unexpected(read.error());
    first = *std::move(read);
  }
  const auto mine = ListShard::begin(tasks, options.shard,
                                     options.estimate ? std::string() : options.shard_folder, arguments);
  if (!mine) return tl::unexpected(mine.error());
  auto report = runBatch(mine->tasks(), job, [&](const BatchTask& task, engine::JobControl& j) {
    return compareOne(pairOf(task.in), first, j);
  });
  if (report)
    if (auto status = mine->keep(*report); !status) return tl::unexpected(status.error());
  return report;
}

engine::Result<Report> compare(const CompareArguments& options, const std::vector<std::string>& arguments,
                               engine::JobControl& job) {
  if (auto status = checkListShard(options.shard, options.shard_folder); !status)
    return tl::unexpected(status.error());
  if (options.others.size() > 1 || !options.shard.empty()) return compareAll(options, arguments, job);
  CompareArguments pair = options;
  pair.b = options.others.front();
  std::optional<engine::Imported> first;
  const ProgressLine progress(job);
  return compareOne(pair, first, job);
}

}  // namespace

void printCompared(const Report& report) {
  if (report.contains("files")) {
    for (const Report& file : report["files"]) {
      fmt::print("{}{}\n", file["in"].get<std::string>(), file.contains("error") ? "  failed" : "");
      if (!file.contains("error")) printCompared(file);
      fmt::print("\n");
    }
    fmt::print("{} compared, {} failed\n", report["done"].get<std::size_t>(),
               report["failed"].get<std::size_t>());
    return;
  }
  if (report.contains("text")) return printReport(report);
  if (report.contains("align")) printAlignment(report["align"]);
  Report rest = report;
  rest.erase("align");
  rest.erase("in");
  printReport(rest);
}

void addCompare(Command root, Chosen& chosen) {
  auto options = std::make_shared<CompareArguments>();
  Command command = addCommand(
      root, chosen, "compare", "How B deviates from A; against a truth, the errors of B and where they are",
      [options, &chosen](engine::JobControl& job) { return compare(*options, chosen.arguments, job); },
      printCompared, Progress::kOwn, batchStatus);
  command.add({
      {.name = "A",
       .to = &options->a,
       .text = "The scan to compare with; A or B may be -, standard input",
       .kind = ValueKind::kInput,
       .required = true},
      {.name = "B",
       .to = &options->others,
       .text = "The scan to compare, or the nominal shape of A as a mesh, .stl. Several, each with a report "
               "of its "
               "own: all are compared with A, or where the last is a mesh, A and all others with that",
       .kind = ValueKind::kInput,
       .required = true},
      {.name = "--truth",
       .to = &options->truth,
       .text = "The true surface: adds RMSE overall, on flats and near edges",
       .kind = ValueKind::kInput},
      {.name = "--edges",
       .to = &options->edges,
       .text = "Picture of the true edges, non-zero = edge: adds the edge width",
       .kind = ValueKind::kMarks},
      {.name = "--deviation",
       .to = &options->deviation,
       .text = "Also write B - A, of a mesh B how A deviates from it, as a scan in A's height unit",
       .kind = ValueKind::kOutput},
  });
  command.add({{.name = "--align",
                .to =
                    [options](const std::string& moves) {
                      options->aligned = true;
                      options->align.moves = moves;
                    },
                .text = "First move B onto the samples of A, as fettle align does",
                .words = alignWords()}});
  addRegionOptions(command, options->counted, "The samples of A that count");
  addAlignOptions(command, options->align);
  addInspectOptions(command, options->inspect);
  addForceOption(command, options->replacing);
  command.add({{.name = "--to",
                .to = &options->to,
                .text = "With --deviation -, standard output: its format, as extension",
                .kind = ValueKind::kFormat,
                .proposed = extensionWords(&engine::FormatInfo::writes)}});
  addEstimateOption(command, options->estimate);
  addListShardOptions(command, options->shard, options->shard_folder);
  addScanOptions(command, options->reading);
  command.notes(
      "Of a mesh B the deviation is that of A from it, above 0 where the part has more. A sample over or "
      "under no "
      "triangle counts as no_nominal and in no other figure. Without --align a mesh lies where its "
      "coordinates are those "
      "of A's world, or, where it would lie wholly beside A, in millimetres from A's lower left sample.\n"
      "Where not all samples count, the others are left out of both: of all figures, of the deviation that "
      "is "
      "written, and of what is compared with a truth. Holes of A are in no region, so that none are counted "
      "there.");
  command.examples({{"fettle compare scan.tif clean.tif", "Deviation figures, Sq and Sa"},
                    {"fettle compare scan.tif clean.tif --truth truth.tif --edges edges.png",
                     "Errors against a known surface, on flats and near edges"},
                    {"fettle compare scan.tif clean.tif --align all --deviation wear.tif",
                     "What differs after the second was moved onto the first"},
                    {"fettle compare scan.tif clean.tif --region \"rectangle 1,1,6,4\"",
                     "Deviation figures between two corners"},
                    {"fettle compare scan.tif nominal.stl --align all --distance shortest --tolerance 0.05mm",
                     "How a part deviates from its nominal shape"},
                    {"fettle compare scan.tif clean.tif other.tif --shard 1/2 --shard-dir compared",
                     "Of several scans the first of two shares, each compared with the first scan"}});
}

}  // namespace fettle::app
