#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/fit_text.h"
#include "app/commands/output_checks.h"
#include "app/commands/region_option.h"
#include "app/commands/rounding_warning.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/section_options.h"
#include "app/terminal.h"
#include "app/work/field_fits.h"
#include "app/work/fit_noise.h"
#include "app/work/memory_places.h"
#include "app/work/outputs.h"
#include "app/work/streams.h"
#include "app/work/typed_lengths.h"
#include "engine/field/piece.h"
#include "engine/formats/formats.h"
#include "engine/io/files/atomic_file.h"

namespace fettle::app {

namespace {

struct FitArguments : RegionArguments {
  std::string scan;
  std::vector<std::string> shapes;
  std::string distance = "orthogonal";
  bool robust = false;
  std::string lines;
  std::optional<double> margin;
  std::optional<double> least;
  std::vector<std::string> at;
  std::vector<int> between;
  std::string csv, step, residuals;
  Replacing replacing = Replacing::kNoWork;
  bool estimate = false;
  ScanOptions reading;
  engine::ExportOptions writing;
};

engine::Status checkFit(const FitArguments& options) {
  if (auto status = checkRegion(options); !status) return status;
  for (const std::string& text : options.at)
    if (lengthsOf(text, 2).empty())
      return engine::inputError(fmt::format("'{}' is no place", text), "--at",
                                "give X,Y in mm from the lower left sample, or as 12.5mm,3mm");
  if (!options.between.empty() && options.between[0] == options.between[1])
    return engine::inputError("nothing lies between a fit and itself", "--between",
                              "name two regions, as 1,2");
  if (const std::string extension = engine::extensionOf(options.step);
      !options.step.empty() && extension != ".step" && extension != ".stp")
    return engine::inputError("a STEP file is written to it", options.step, "name it .step or .stp");
  return {};
}

std::vector<engine::ShapeKind> kindsOf(const FitArguments& options) {
  std::vector<engine::ShapeKind> kinds;
  const bool all = options.shapes.empty() || std::ranges::count(options.shapes, "auto") > 0;
  for (const engine::ShapeInfo& info : engine::shapeInfos())
    if (all || std::ranges::count(options.shapes, info.word) > 0) kinds.push_back(info.kind);
  return kinds;
}

// The regions that are fitted, those of --at in its order.
engine::Result<std::vector<engine::FitRegion>> regionsOf(const FitArguments& options,
                                                         const engine::Version& field,
                                                         engine::JobControl& job) {
  const engine::Region counted = regionOf(options.region);
  const bool lines = field.lines() != nullptr && !field.lines()->empty();
  if (!lines && options.at.empty()) {
    if (options.margin)
      return engine::inputError("there is no line to keep a margin from", "--margin", "give --lines");
    auto whole = engine::wholeRegion(field, counted, job);
    if (!whole) return tl::unexpected(whole.error());
    if (whole->samples == 0) return engine::nothingIn(counted, shownInput(options.scan));
    return std::vector<engine::FitRegion>{*std::move(whole)};
  }
  engine::FitRegionOptions how;
  how.region = counted;
  how.margin = options.margin.value_or(how.margin);
  how.least = options.at.empty()
                  ? static_cast<std::int64_t>(options.least.value_or(static_cast<double>(how.least)))
                  : 1;
  auto regions = engine::regionsBetween(
      field, lines ? std::span<const engine::EdgeLine>(*field.lines()) : std::span<const engine::EdgeLine>(),
      how, job);
  if (!regions) return tl::unexpected(regions.error());
  if (options.at.empty()) {
    if (regions->empty())
      return engine::inputError(fmt::format("no region has {} samples", how.least), shownInput(options.scan),
                                "lower --least or --margin");
    return regions;
  }
  std::vector<engine::FitRegion> chosen;
  std::vector<int> numbers;
  for (const std::string& text : options.at) {
    const std::vector<double> xy = lengthsOf(text, 2);
    const int found =
        engine::regionAt(*regions, {xy[0] / field.grid().spacingXMm(), xy[1] / field.grid().spacingYMm()});
    if (found < 0)
      return engine::inputError(fmt::format("no region holds the place {}", text), "--at",
                                "is it a hole, next to a line, or outside?");
    if (const auto before = std::ranges::find(numbers, found); before != numbers.end())
      warn(fmt::format("--at {} and --at {} lie in the same region, which is fitted twice",
                       options.at[static_cast<std::size_t>(before - numbers.begin())], text));
    numbers.push_back(found);
    chosen.push_back((*regions)[static_cast<std::size_t>(found)]);
  }
  return chosen;
}

// As if the samples of all regions were those of one.
engine::Result<Foreseen> foreseeFit(const FitArguments& options, const engine::Version& field,
                                    const std::vector<engine::FitRegion>& regions,
                                    const std::vector<engine::ShapeKind>& kinds,
                                    const engine::FitOptions& how, engine::JobControl& job) {
  std::int64_t samples = 0;
  for (const engine::FitRegion& region : regions) samples += region.samples;
  PlannedOnPieces fitting;
  fitting.share = static_cast<double>(samples) / static_cast<double>(field.grid().samples());
  fitting.work = [&](const engine::SampleRect& r,
                     engine::JobControl& own) -> engine::Result<engine::Version> {
    const engine::Version piece = engine::pieceOf(field, r.column, r.row, r.columns, r.rows);
    auto region = engine::wholeRegion(piece, engine::Region::kAll, own);
    if (!region) return tl::unexpected(region.error());
    auto chosen = engine::fitBestShape(piece, *region, kinds, how, own);
    // What the samples of a piece do not determine was tried all the same.
    if (!chosen && chosen.error().kind == engine::ErrorKind::kInput) return piece;
    if (!chosen) return tl::unexpected(chosen.error());
    if (options.residuals.empty()) return piece;
    return residualField(piece, {{1, *std::move(region), *std::move(chosen)}}, how.vertical, own);
  };
  const PlannedWork planned{.field = field,
                            .original = field,
                            .steps = {fitting},
                            .out = memoryPlace(options.residuals) == nullptr ? options.residuals : "",
                            .extension = engine::extensionOf(options.residuals),
                            .writing = options.writing};
  return foresee(planned, shownInput(options.scan), options.estimate, job);
}

engine::Result<Report> fit(const FitArguments& options, engine::JobControl& job) {
  if (auto status = checkFit(options); !status) return tl::unexpected(status.error());
  if (auto status = checkOutputs({{options.csv, OutputKind::kText, ".csv"},
                                  {options.step, OutputKind::kText},
                                  {options.residuals, OutputKind::kField}},
                                 {options.scan, options.lines, options.marks}, options.replacing, job);
      !status)
    return tl::unexpected(status.error());
  const auto imported = loadScan(options.scan, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const auto marked = countedOf(imported->field, imported->original, options.scan, options, job);
  if (!marked) return tl::unexpected(marked.error());
  warnOfFilled(*marked, imported->original, options.scan);
  const auto field = withLines(*marked, options.lines, job);
  if (!field) return tl::unexpected(field.error());
  if (imported->in_perspective)
    warn(
        fmt::format("{}: in a camera's perspective a shape is another one: convert the scan to points and "
                    "grid them first",
                    shownInput(options.scan)));
  engine::FitOptions how;
  how.vertical = options.distance == "vertical";
  how.robust = options.robust;
  if (auto status = setNoise(how, *field, job); !status) return tl::unexpected(status.error());
  auto regions = regionsOf(options, *field, job);
  if (!regions) return tl::unexpected(regions.error());

  const std::vector<engine::ShapeKind> kinds = kindsOf(options);
  auto foreseen = foreseeFit(options, *field, *regions, kinds, how, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  auto fits = fitEach(*field, *std::move(regions), kinds, how, job);
  if (!fits) return tl::unexpected(fits.error());
  for (const std::string& warning : fits->warnings) warn(warning);
  if (!options.between.empty())
    if (auto status = addRelation(*fits, options.between[0], options.between[1]); !status)
      return tl::unexpected(status.error());
  const std::vector<FittedRegion>& fitted = fits->fitted;
  // Of several the one that is left the least of.
  double least = std::numeric_limits<double>::infinity();
  for (const FittedRegion& each : fitted) least = std::min(least, each.chosen.fit.rms_mm);
  warnOfRounding({&imported->field}, least / field->grid().height_unit.mm, "the rms of what a shape leaves",
                 shownInput(options.scan));
  Report& report = fits->report;
  if (!options.residuals.empty()) {
    const auto map = residualField(*field, fitted, how.vertical, job);
    if (!map) return tl::unexpected(map.error());
    engine::ExportOptions writing = options.writing;
    writing.original = *map;
    if (auto status = saveField(*map, options.residuals, job, writing); !status)
      return tl::unexpected(status.error());
    report["residuals"] = options.residuals;
  }
  if (!options.step.empty())
    if (auto status = engine::writeFileAtomically(options.step, fitStep(*field, fitted)); !status)
      return tl::unexpected(status.error());
  if (!options.csv.empty())
    if (auto status = writeTo(
            options.csv, ".csv", job,
            [&](const std::string& path) { return engine::writeFileAtomically(path, fitCsv(report)); });
        !status)
      return tl::unexpected(status.error());
  return std::move(report);
}

constexpr const char* kRegionGroup = "Regions";

std::vector<Word> fitShapeWords() {
  std::vector<Word> words;
  for (const engine::ShapeInfo& info : engine::shapeInfos())
    words.emplace_back(std::string(info.word), std::string(info.text));
  words.emplace_back("auto", "the simplest that the samples do not contradict");
  return words;
}

}  // namespace

void addFit(Command root, Chosen& chosen) {
  auto options = std::make_shared<FitArguments>();
  Command command = addCommand(
      root, chosen, "fit", "Plane, sphere, cylinder, cone, torus between edge lines, with standard errors",
      [options](engine::JobControl& job) { return fit(*options, job); }, printFits);
  command.add(
      {{.name = "SCAN",
        .to = &options->scan,
        .text = "The scan, or a session; - for standard input",
        .kind = ValueKind::kInput,
        .required = true},
       {.name = "--shape",
        .to = &options->shapes,
        .text = "The shapes that are tried; of several the one is taken that describes the samples best",
        .words = fitShapeWords(),
        .otherwise = "auto",
        .between = ','},
       {.name = "--distance",
        .to = &options->distance,
        .text = "The distances whose squares are made small",
        .words = {{"orthogonal",
                   "the shortest to the shape, as the standards of coordinate metrology have it"},
                  {"vertical", "along z, in which a scanner has its noise"}}},
       {.name = "--robust",
        .to = &options->robust,
        .text = "Samples far from the shape do not count; half of them must be near to it"},
       {.name = "--between",
        .to = &options->between,
        .text = "Also angle and distance between the fits of two regions, by their numbers",
        .shown = "K,L",
        .values = 2,
        .between = ','}});
  command.add(
      {{.name = "--lines",
        .to = &options->lines,
        .text = "Edge lines between which regions lie, instead of those of a session",
        .kind = ValueKind::kLines},
       {.name = "--margin",
        .to = &options->margin,
        .text =
            "Samples this near to a line belong to no region; gaps of lines up to twice as wide are closed",
        .range = Range{1.0, 1000.0},
        .unit = "samples",
        .otherwise = "2"},
       {.name = "--least",
        .to = &options->least,
        .text = "Regions between lines with fewer samples are left out",
        .range = Range{1.0, 1e12},
        .unit = "samples",
        .otherwise = "100"},
       {.name = "--at",
        .to = &options->at,
        .text = "Only the connected region around this place, from the lower left sample",
        .unit = "mm",
        .shown = "X,Y",
        .one_word = true}},
      kRegionGroup);
  addRegionOptions(command, *options, "The samples that count", kRegionGroup);
  command.add({{.name = "--csv",
                .to = &options->csv,
                .text = "Write a row per figure: region, shape, figure, value, standard error, unit",
                .kind = ValueKind::kOutput},
               {.name = "--step",
                .to = &options->step,
                .text = "Write the shapes, bounded as the samples are, as STEP AP214, .step or .stp",
                .kind = ValueKind::kNewFile},
               {.name = "--residuals",
                .to = &options->residuals,
                .text = "Write the distances of the samples from their shapes as a scan, above 0 above them",
                .kind = ValueKind::kNewScan}},
              kWriting);
  addForceOption(command, options->replacing);
  addEstimateOption(command, options->estimate);
  addCompressOption(command, options->writing);
  addScanOptions(command, options->reading);
  command.notes(
      "Without edge lines all samples that count are one region. Regions are numbered from the largest on, "
      "those of --at "
      "in its order. Positions are in mm from the lower left sample.\n"
      "auto takes a shape in place of a simpler one that it contains only where it lowers the rms by a tenth "
      "at least. What "
      "the samples do not determine, as the radius of a plane, is refused by its name.\n"
      "Standard errors are those that noise in height gives, and more where sums over parts of the region "
      "scatter by more. "
      "Deviations of form as long as the region are not counted. What noise moves figures by on average, as "
      "a "
      "radius by orthogonal distances, is in --json, and a warning says where it is more than a third of the "
      "error.");
  command.examples(
      {{"fettle fit scan.tif", "The shape that all samples have"},
       {"fettle fit scan.tif --at 5,5 --shape plane --robust --residuals flatness.tif",
        "The plane through the samples around a place, and their distances from it"},
       {"fettle fit scan.tif --at 2,2 --at 5,5 --shape plane --between 1,2 --csv fits.csv --step fits.step",
        "Two planes, angle and distance between them, as table and for a CAD program"}});
}

}  // namespace fettle::app
