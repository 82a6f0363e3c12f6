#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/filling.h"
#include "app/commands/known_steps.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/streams.h"
#include "engine/base/stopwatch.h"
#include "engine/fill/fill.h"
#include "engine/fill/filled_samples.h"
#include "engine/formats/formats.h"

namespace fettle::app {

namespace {

struct FillRun {
  BatchOptions files;
  FillArguments what;
  std::string keep;
  std::string lines;
  std::string filled_out;
  bool estimate = false;
  ScanOptions reading;
  engine::ExportOptions writing;
};

// The filled samples as marks alone.
engine::Status saveFilled(const engine::Version& filled, const engine::Version& before,
                          const std::string& path, engine::JobControl& job) {
  const auto marked = engine::withFilledMarked(filled, before, engine::OtherMarks::kGo, job);
  if (!marked) return tl::unexpected(marked.error());
  return saveMarks(*marked, path, job);
}

void sayWhatIsBeyond(const engine::Filled& done, const engine::Version& before, const std::string& scan) {
  const engine::BeyondBefore beyond = engine::beyondBefore(before, done.field);
  const std::string& unit = before.grid().height_unit.name;
  if (beyond.below > 0.0 || beyond.above > 0.0)
    warn(fmt::format(
        "{}: filled heights reach {:.4g} {} below the lowest and {:.4g} {} above the highest of the scan: "
        "--method membrane stays between the heights of the rim, --max-extent leaves large holes",
        shownInput(scan), beyond.below, unit, beyond.above, unit));
}

void sayWhatStays(const engine::Filled& done, const std::string& scan, const engine::FillOptions& options) {
  if (done.too_many > 0)
    warn(fmt::format("{}: {} hole{} of more than {} samples stay{}: their equations are too large",
                     shownInput(scan), done.too_many, done.too_many == 1 ? "" : "s", options.mostSamples(),
                     done.too_many == 1 ? "s" : ""));
  if (done.no_rim > 0)
    warn(fmt::format("{}: {} hole{} without a height next to {} stay{}", shownInput(scan), done.no_rim,
                     done.no_rim == 1 ? "" : "s", done.no_rim == 1 ? "it" : "them",
                     done.no_rim == 1 ? "s" : ""));
}

engine::Result<Foreseen> foreseeFill(const FillRun& options, const engine::FillOptions& fill,
                                     const BatchTask& task, const engine::Version& field,
                                     const engine::Imported& imported, engine::JobControl& job) {
  const engine::Version& original = imported.original ? *imported.original : imported.field;
  engine::ExportOptions writing = options.writing;
  writing.original = original;
  const PlannedWork planned{
      .field = field,
      .original = original,
      .steps = {plannedFill(field, fill)},
      .out = task.out,
      .extension = isStream(task.out) ? withDot(task.to) : engine::extensionOf(task.out),
      .writing = writing};
  return foresee(planned, shownOutput(task.out), options.estimate, job);
}

engine::Result<Report> fillOne(const FillRun& options, const BatchTask& task, engine::JobControl& job) {
  const auto imported = loadScan(task.in, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const auto fill = fillOptionsOf(options.what, imported->field.grid());
  if (!fill) return tl::unexpected(fill.error());
  const auto kept = withMarks(imported->field, options.keep, job);
  if (!kept) return tl::unexpected(kept.error());
  const auto lined = withLines(*kept, options.lines, job);
  if (!lined) return tl::unexpected(lined.error());
  engine::Result<Foreseen> foreseen;
  if (memoryPlace(task.out) == nullptr) foreseen = foreseeFill(options, *fill, task, *lined, *imported, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  const engine::Stopwatch watch;
  const auto done = engine::fillHoles(*lined, *fill, job);
  if (!done && done.error().kind == engine::ErrorKind::kInput)
    return engine::inputError(done.error().what, shownInput(task.in), done.error().remedy);
  if (!done) return tl::unexpected(done.error());
  const double seconds = watch.seconds();
  sayWhatStays(*done, task.in, *fill);
  sayWhatIsBeyond(*done, imported->field, task.in);
  engine::ExportOptions writing = options.writing;
  // A height that was removed and is filled now was not measured: the session's scan loses it.
  auto measured = engine::withoutReplaced(imported->original.value_or(imported->field), imported->field,
                                          done->field, job);
  if (!measured) return tl::unexpected(measured.error());
  writing.original = *std::move(measured);
  auto known = KnownSteps::of(*imported, task, job);
  if (!known) return tl::unexpected(known.error());
  for (const auto& [file, what] :
       {std::pair(&options.keep, "marks of --keep"), {&options.lines, "edge lines of --lines"}})
    if (!file->empty()) known->leftOut(fmt::format("the {}: they belong to this scan", what));
  known->did(RecipeFill{options.what});
  known->note(writing);
  if (done->filled > 0 && options.filled_out.empty() && memoryPlace(task.out) == nullptr &&
      !writesSession(task))
    warn(fmt::format("{}: only a session stores which samples were filled{}", shownOutput(task.out),
                     options.files.many() ? "" : ": add --filled-out for others"));
  if (!options.filled_out.empty())
    if (auto status = saveFilled(done->field, imported->field, options.filled_out, job); !status)
      return tl::unexpected(status.error());
  if (auto status = saveField(done->field, task.out, job, writing, task.to); !status)
    return tl::unexpected(status.error());
  return Report{{"method", options.what.method},
                {"holes", done->holes},
                {"filled_holes", done->filled_holes},
                {"filled", done->filled},
                {"larger", done->larger},
                {"at_border", done->at_border},
                {"too_many_samples", done->too_many},
                {"no_rim", done->no_rim},
                {"undetermined", done->undetermined},
                {"no_data", engine::summarize(done->field).no_data},
                {"seconds", seconds},
                {"hash", hashOf(done->field)}};
}

engine::Result<Report> fill(const FillRun& options, engine::JobControl& job) {
  if (!options.filled_out.empty() && options.files.many())
    return engine::inputError("one picture cannot hold the filled samples of several scans", "--filled-out",
                              "give one scan, or sessions with --to fettle");
  const auto tasks = batchTasks(options.files, {options.keep, options.lines}, job);
  if (!tasks) return tl::unexpected(tasks.error());
  if (auto status = checkCompress(options.writing, *tasks); !status) return tl::unexpected(status.error());
  if (!options.filled_out.empty()) {
    const BatchTask& task = tasks->front();
    if (auto status = checkOutputs(
            {{task.out, OutputKind::kField, task.to}, {options.filled_out, OutputKind::kMarks, kMarksStream}},
            {task.in, options.keep, options.lines}, options.files.replacing, job);
        !status)
      return tl::unexpected(status.error());
  }
  const auto one = [&](const BatchTask& task, engine::JobControl& j) { return fillOne(options, task, j); };
  if (options.files.many()) return runBatch(*tasks, job, one);
  const ProgressLine progress(job);
  return one(tasks->front(), job);
}

}  // namespace

void addFill(Command root, Chosen& chosen) {
  auto options = std::make_shared<FillRun>();
  Command command = addCommand(
      root, chosen, "fill", "Fill holes of scans from their rim, never across an edge",
      [options](engine::JobControl& job) { return fill(*options, job); }, printBatch, Progress::kOwn,
      batchStatus);
  addBatchOptions(command, options->files);
  command.add({
      {.name = "--method",
       .to = &options->what.method,
       .text = "The surface through the rim that has the least",
       .words = {{"curvature",
                  "squared curvatures, a thin plate: goes on with the slopes of the rim, of two "
                  "samples, and so with their noise"},
                 {"membrane",
                  "squared slopes, a soap film: stays between the lowest and the highest of the rim"}}},
      {.name = "--max-extent",
       .to = &options->what.most_extent,
       .text = "Longest side of a hole that is filled: of the rectangle around it",
       .kind = ValueKind::kLength,
       .otherwise = "any"},
      {.name = "--max-area",
       .to = &options->what.most_area,
       .text = "Largest area of a hole that is filled: that of its samples",
       .range = Range{1e-15, 1e15},
       .unit = "mm^2",
       .otherwise = "any"},
      {.name = "--border",
       .to = &options->what.at_border,
       .text = "Also holes that reach the border of the field: there the surface ends freely"},
      {.name = "--keep",
       .to = &options->keep,
       .text = "Picture of marks: marked holes stay, and no slope is carried over marked samples",
       .kind = ValueKind::kMarks},
      {.name = "--lines",
       .to = &options->lines,
       .text =
           "Edge lines, .csv, .geojson, .gpkg or .dxf, instead of those of a session: each side is filled "
           "up to a step, and a crease stays sharp; draw them through holes",
       .kind = ValueKind::kLines},
      {.name = "--filled-out",
       .to = &options->filled_out,
       .text = "Write which samples were filled, as a picture of marks",
       .kind = ValueKind::kNewMarks},
  });
  addEstimateOption(command, options->estimate);
  addCompressOption(command, options->writing);
  addScanOptions(command, options->reading);
  command.notes(fmt::format(
      "Holes are what is connected along rows and columns. One with more than {} samples (membrane) or {} "
      "(curvature) stays. Samples with a height keep every bit.\n"
      "A session stores the scan with its holes, and so knows which samples were filled: info and measure "
      "count them, --region measured leaves them out, mark --filled marks them.",
      engine::FillOptions::kMostMembrane, engine::FillOptions::kMostCurvature));
  command.examples({{"fettle fill scan.tif full.tif --max-extent 0.5mm --filled-out filled.png",
                     "Holes of up to half a millimetre, and a picture of what is no measurement"},
                    {"fettle fill scan.tif full.fettle --lines lines.csv",
                     "Each side of the edges for itself, as a session that knows which samples were filled"},
                    {"fettle fill *.tif --out-dir full --method membrane", "Many scans, by a soap film"}});
}

}  // namespace fettle::app
