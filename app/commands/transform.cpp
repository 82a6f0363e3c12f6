#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/known_steps.h"
#include "app/commands/original_scan.h"
#include "app/commands/recipe_file.h"
#include "app/commands/region_option.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/transforming.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/streams.h"

namespace fettle::app {

namespace {

struct TransformRun {
  BatchOptions files;
  TransformArguments what;
  bool estimate = false;
  ScanOptions reading;
  engine::ExportOptions writing;
};

engine::Result<Foreseen> foreseeTransform(const TransformRun& options, const BatchTask& task,
                                          const engine::Imported& imported, engine::JobControl& job) {
  const engine::Grid& grid = imported.field.grid();
  const auto made = transformedGrid(grid, options.what);
  if (!made) return tl::unexpected(made.error());
  const engine::Version& original = imported.original ? *imported.original : imported.field;
  engine::ExportOptions writing = options.writing;
  if (imported.original) writing.original = original;
  const PlannedWork planned{
      .field = imported.field,
      .original = original,
      .steps = {plannedTransform(imported.field, original, options.what, grid,
                                 imported.original ? WithOriginal::kYes : WithOriginal::kNo)},
      .out = task.out,
      .extension = isStream(task.out) ? withDot(task.to) : engine::extensionOf(task.out),
      .writing = writing,
      .result = static_cast<double>(made->samples()) / static_cast<double>(grid.samples())};
  return foresee(planned, shownOutput(task.out), options.estimate, job);
}

engine::Result<Report> transformOne(const TransformRun& options, const BatchTask& task,
                                    engine::JobControl& job) {
  const auto imported = loadScan(task.in, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  engine::Result<Foreseen> foreseen;
  if (memoryPlace(task.out) == nullptr) foreseen = foreseeTransform(options, task, *imported, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  const auto result = transformed(imported->field, options.what, job);
  if (!result) return tl::unexpected(result.error());
  warnOfFormLeft(imported->field, result->field, task.in);
  engine::ExportOptions writing = options.writing;
  auto known = KnownSteps::of(*imported, task, job);
  if (!known) return tl::unexpected(known.error());
  known->didToBoth(RecipeTransform{options.what});
  known->note(writing);
  // Changes are limited from here on, also in Python: the scan before lies elsewhere.
  writing.original = result->field;
  if (imported->original) {
    // What the session began with goes along, so that changes and filled samples stay known.
    auto original = transformed(*imported->original, options.what, job);
    if (!original) return tl::unexpected(original.error());
    writing.original = std::move(original->field);
  }
  const engine::Grid& grid = result->field.grid();
  if (grid.crs_wkt.empty() && !imported->field.grid().crs_wkt.empty())
    warn(
        fmt::format("{}: turned, its samples are no longer where its coordinate system says: it is written "
                    "without one",
                    shownInput(task.in)));
  warnOfFilledLost(result->field, writing.original, task.out, task.to);
  if (auto status = saveField(result->field, task.out, job, writing, task.to); !status)
    return tl::unexpected(status.error());
  const engine::FieldSummary summary = engine::summarize(result->field);
  if (summary.no_data == grid.samples() &&
      engine::summarize(imported->field).no_data < imported->field.grid().samples())
    warn(
        fmt::format("{}: every new sample is a hole, since {}: fill single holes first, or choose another {}",
                    shownInput(task.in),
                    result->method == engine::Resampling::kArea ? "less than half of its cell is known"
                                                                : "the old one nearest to it is one",
                    result->method == engine::Resampling::kArea ? "--method" : "spacing"));
  Report report{{"width", grid.width},
                {"height", grid.height},
                {"spacing_x", grid.spacing_x},
                {"spacing_y", grid.spacing_y},
                {"spacing_unit", grid.lateral_unit.name},
                {"origin_x", grid.origin_x},
                {"origin_y", grid.origin_y},
                {"no_data", summary.no_data},
                {"marked", summary.marked}};
  if (result->method)
    report["method"] = *result->method == engine::Resampling::kArea     ? "area"
                       : *result->method == engine::Resampling::kLinear ? "linear"
                                                                        : "cubic";
  report["hash"] = hashOf(result->field);
  return report;
}

engine::Result<Report> transform(const TransformRun& options, engine::JobControl& job) {
  if (auto status = checkTransform(options.what); !status) return tl::unexpected(status.error());
  const auto tasks = batchTasks(options.files, {}, job);
  if (!tasks) return tl::unexpected(tasks.error());
  if (auto status = checkCompress(options.writing, *tasks); !status) return tl::unexpected(status.error());
  const auto one = [&](const BatchTask& task, engine::JobControl& j) {
    return transformOne(options, task, j);
  };
  if (options.files.many()) return runBatch(*tasks, job, one);
  const ProgressLine progress(job);
  return one(tasks->front(), job);
}

}  // namespace

void addTransform(Command root, Chosen& chosen) {
  auto options = std::make_shared<TransformRun>();
  Command command = addCommand(
      root, chosen, "transform", "Crop, mirror, turn and resample scans",
      [options](engine::JobControl& job) { return transform(*options, job); }, printBatch, Progress::kOwn,
      batchStatus);
  addBatchOptions(command, options->files);
  command.add({
      {.name = "--crop",
       .to = &options->what.crop,
       .text = "Keep the samples in this rectangle: two corners, from the lower left sample",
       .unit = "mm",
       .shown = "X,Y,X,Y",
       .values = 4,
       .between = ','},
      {.name = "--crop-samples",
       .to = &options->what.crop_samples,
       .text = "Keep these samples, counted from 0 at the top left, as info --at does",
       .shown = "ROW,COLUMN,ROWS,COLUMNS",
       .values = 4,
       .between = ',',
       .excludes = {"--crop"}},
      {.name = "--mirror",
       .to = &options->what.mirror,
       .text = "Then mirror",
       .words = {{"x", "left and right change places"}, {"y", "top and bottom change places"}}},
      {.name = "--turn",
       .to = &options->what.turn,
       .text = "Then turn counter-clockwise about the middle, every height as it is",
       .unit = "degrees",
       .words = {"90", "180", "270"}},
      {.name = "--angle",
       .to = &options->what.angle,
       .text = "Then turn counter-clockwise about the middle by any angle; the result holds all of the scan",
       .range = Range{-360.0, 360.0},
       .unit = "degrees"},
      {.name = "--to-spacing",
       .to = &options->what.to_spacing,
       .text = "New distance of samples, the same along x and y or one each: in the scan's unit, or as 20um",
       .shown = "X[,Y]",
       .otherwise = "as it is",
       .between = ',',
       .one_word = true},  // "--to-spacing 0.1mm IN OUT": the next word is the scan
      {.name = "--method",
       .to = &options->what.method,
       .text = "How heights between samples come about",
       .words = {{"area", "mean of the cells that the new one covers"},
                 {"linear", "the bilinear patch between four samples"},
                 {"cubic", "cubic convolution of 4 x 4 samples, which may overshoot at steps"}},
       .otherwise = "area where samples get farther apart, else cubic"},
  });
  addEstimateOption(command, options->estimate);
  addCompressOption(command, options->writing);
  addScanOptions(command, options->reading);
  command.notes(
      "Steps are done in the order of this list. Where samples get farther apart by a factor s, every kernel "
      "is "
      "s times as wide, so that what is finer than the new spacing is averaged.\n"
      "Marks, edge lines, the form that lies over a session and the scan that it began with go along. A new "
      "sample is a hole where the old one nearest to it is; by area, where samples get farther apart, where "
      "less than half of its cell is known. Elsewhere holes do not count, and cubic becomes linear beside "
      "them. It is marked "
      "where an old marked one lies in its cell. A crop and a new spacing keep the place in the world; a "
      "turned "
      "or mirrored scan keeps its middle there and has no coordinate system.");
  command.examples(
      {{"fettle transform scan.tif part.tif --crop 10,10,30,20", "The samples from 10,10 to 30,20 mm"},
       {"fettle transform scan.tif coarse.tif --to-spacing 0.1mm",
        "A sample every 0.1 mm, by means of areas"},
       {"fettle transform scan.tif level.tif --angle -3.5", "Turned clockwise by 3.5 degrees"}});
}

}  // namespace fettle::app
