#include <memory>
#include <string>
#include <vector>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/form_option.h"
#include "app/commands/known_steps.h"
#include "app/commands/level_layer.h"
#include "app/commands/levelling.h"
#include "app/commands/original_scan.h"
#include "app/commands/recipe_file.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/streams.h"
#include "engine/fill/filled_samples.h"
#include "engine/formats/formats.h"

namespace fettle::app {

namespace {

struct LevelArguments {
  BatchOptions files;
  LineArguments lines;
  FormArguments form;
  std::string layer;  // empty: the form becomes heights
  bool estimate = false;
  ScanOptions reading;
  engine::ExportOptions writing;
};

engine::Result<Foreseen> foreseeLevel(const LevelArguments& options, const BatchTask& task,
                                      const engine::Version& field, const engine::Version& counted,
                                      const LineArguments& lines, engine::JobControl& job) {
  const PlannedWork planned{
      .field = field,
      .original = field,
      .steps = {plannedLevel(field, counted, lines, options.form, Lowered::kOnce)},
      .out = task.out,
      .extension = isStream(task.out) ? withDot(task.to) : engine::extensionOf(task.out),
      .writing = options.writing};
  return foresee(planned, shownOutput(task.out), options.estimate, job);
}

engine::Result<Report> levelOne(const LevelArguments& options, const BatchTask& task,
                                engine::JobControl& job) {
  const auto imported = loadScan(task.in, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  auto counted = countedOf(imported->field, imported->original, task.in, options.form, job);
  if (!counted) return tl::unexpected(counted.error());
  const LineArguments& lines = options.lines;
  engine::Result<Foreseen> foreseen;
  if (memoryPlace(task.out) == nullptr)
    foreseen = foreseeLevel(options, task, imported->field, *counted, lines, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  const auto levelling = levellingOf(*counted, task.in, *imported, lines, options.form, job);
  if (!levelling) return tl::unexpected(levelling.error());
  warnOfLeaving(levelling->fit, task.in);
  if (auto status = warnOfMovedLines(*levelling, *counted, task.in, lines, job); !status)
    return tl::unexpected(status.error());
  // Of the scan as it was read: the marks chose the samples that count, it keeps its own; and it is rounded once.
  const auto levelled = levelling->takenFrom(imported->field, job);
  if (!levelled) return tl::unexpected(levelled.error());
  // Changes are limited from here on, also of a session or in Python.
  engine::ExportOptions writing = options.writing;
  writing.original = *levelled;
  if (imported->original) {
    // What was filled stays known.
    auto measured = engine::withoutFilled(*levelled, *imported->original, job);
    if (!measured) return tl::unexpected(measured.error());
    writing.original = *std::move(measured);
  }
  auto known = KnownSteps::of(*imported, task, job);
  if (!known) return tl::unexpected(known.error());
  // Samples that were filled are no region of a recipe.
  RecipeLevel step{lines, options.form};
  if (step.form.region == "measured") {
    known->leftOut("that filled samples did not count in the level");
    step.form.region = "all";
  }
  known->beganWith(step);
  known->note(writing);
  warnOfFilledLost(*levelled, writing.original, task.out, task.to);
  if (auto status = saveField(*levelled, task.out, job, writing, task.to); !status)
    return tl::unexpected(status.error());
  Report report;
  addLevelling(report, lines, options.form, *levelling, imported->field.grid());
  report.update({{"unit", imported->field.grid().height_unit.name},
                 {"samples", levelling->fit.samples},
                 {"rms", levelling->fit.rms},
                 {"rounds", levelling->fit.rounds},
                 {"hash", hashOf(*levelled)}});
  if (options.form.robust) report["rms_counted"] = levelling->fit.rms_counted;
  return report;
}

engine::Result<Report> level(const LevelArguments& options, engine::JobControl& job) {
  const LineArguments& lines = options.lines;
  if (!options.layer.empty() && !lines.rows.empty())
    return engine::inputError("offsets of lines are no form that could lie over a scan", "--rows",
                              "level the lines first, by a run without --layer");
  if (options.layer.empty() && options.form.form == "none" && lines.rows.empty())
    return engine::inputError("there is no form to take out", "--form",
                              "name another than none, or give --rows");
  if (lines.scan_axis != "x" && lines.rows.empty())
    return engine::inputError("there are no lines to level along y", "--scan-axis", "add --rows");
  if (lines.keep_form != LineArguments::kNoForm && lines.rows.empty())
    return engine::inputError("without lines that are levelled all form across them stays", "--keep-form",
                              "add --rows");
  if (auto status = checkForm(options.form); !status) return tl::unexpected(status.error());
  const auto tasks = batchTasks(options.files, {options.form.marks}, job);
  if (!tasks) return tl::unexpected(tasks.error());
  if (auto status = checkCompress(options.writing, *tasks); !status) return tl::unexpected(status.error());
  if (!options.layer.empty())
    if (auto status = checkLayer(options.layer, options.form, *tasks); !status)
      return tl::unexpected(status.error());
  const auto one = [&](const BatchTask& task, engine::JobControl& j) {
    return options.layer.empty() ? levelOne(options, task, j)
                                 : changeLayer({options.layer, options.form, options.reading, options.writing,
                                                options.estimate},
                                               task, j);
  };
  if (options.files.many()) return runBatch(*tasks, job, one);
  const ProgressLine progress(job);
  return one(tasks->front(), job);
}

}  // namespace

void addLevel(Command root, Chosen& chosen) {
  auto options = std::make_shared<LevelArguments>();
  Command command = addCommand(
      root, chosen, "level", "Take a plane, another form or offsets of scanned lines out of scans",
      [options](engine::JobControl& job) { return level(*options, job); }, printBatch, Progress::kOwn,
      batchStatus);
  addBatchOptions(command, options->files);
  command.add({
      {.name = "--rows",
       .to = &options->lines.rows,
       .text = "First level the lines of a line scanner, each by this, of the samples of --region; --robust "
               "for mean and poly. "
               "Where features fill more than half of a line take matching, or leave them out by marks. Slow "
               "form from line to line goes with the lines: see --keep-form",
       .words = lineWords()},
      {.name = "--scan-axis",
       .to = &options->lines.scan_axis,
       .text = "Along which its lines are",
       .words = {{"x", "rows"}, {"y", "columns"}}},
      {.name = "--keep-form",
       .to = &options->lines.keep_form,
       .text =
           "With --rows: form across the lines stays, as far as it is a polynomial of this degree, and "
           "slow drift of the scanner with it; what goes is the rest. 5 keeps a wave as long as the field",
       .range = Range{0.0, engine::LineOptions::kMostFormDegree},
       .otherwise = "all of it goes but the mean height"},
  });
  addFormOptions(command, options->form);
  command.add(
      {{.name = "--layer",
        .to = &options->layer,
        .text = "The form as a layer over a session, which goes in and out exactly, instead of new heights",
        .words = layerWords(),
        .otherwise = "the form is taken out of the heights"}});
  addEstimateOption(command, options->estimate);
  addCompressOption(command, options->writing);
  addScanOptions(command, options->reading);
  command.notes(
      "What is written are heights less the form, rounded to float once; the form itself is not stored. A "
      "session keeps how it was found, and fettle recipe repeats that on other scans. With --layer put a "
      "session stores the samples and the form over them: info, measure, section, render, filter, fill and "
      "replay see the heights without it, other formats get them with it, and a sample that is not changed "
      "keeps its bits.");
  command.examples(
      {{"fettle level scan.tif level.tif", "The plane that is nearest to all samples becomes level"},
       {"fettle level scan.tif level.tif --form poly2 --robust",
        "A slightly bent plate becomes level, whatever stands on it"},
       {"fettle level scan.tif level.tif --through 5,5:95,8:50,90 --probe 1",
        "The plane through three places of a part, each the mean of the samples within 1 mm"},
       {"fettle level scan.tif level.tif --rows median --region unmarked --marks marks.png",
        "Every line of an AFM scan at the same height, then the plane, by what is not marked"},
       {"fettle level scan.tif level.tif --rows matching --keep-form 5 --form none",
        "Stripes go, tilt and slow form stay as they are"},
       {"fettle level scan.tif work.fettle --layer put --form poly2",
        "A session whose samples are the scan's, seen and worked on without their form"},
       {"fettle level work.fettle scan_again.fettle --layer remove", "The same with its form, bit by bit"}});
}

}  // namespace fettle::app
