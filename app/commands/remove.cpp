#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/known_steps.h"
#include "app/commands/region_option.h"
#include "app/commands/removing.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/streams.h"
#include "engine/base/stopwatch.h"
#include "engine/formats/formats.h"
#include "engine/remove/remove.h"

namespace fettle::app {

namespace {

struct RemoveRun {
  BatchOptions files;
  RemoveArguments what;
  RegionArguments region{.region = ""};
  bool estimate = false;
  ScanOptions reading;
  engine::ExportOptions writing;
};

engine::Result<Foreseen> foreseeRemove(const RemoveRun& options, const engine::RemoveOptions& remove,
                                       const BatchTask& task, const engine::Version& field,
                                       const engine::Imported& imported, engine::JobControl& job) {
  const engine::Version& original = imported.original ? *imported.original : imported.field;
  engine::ExportOptions writing = options.writing;
  writing.original = original;
  const PlannedWork planned{
      .field = field,
      .original = original,
      .steps = {plannedRemove(field, remove)},
      .out = task.out,
      .extension = isStream(task.out) ? withDot(task.to) : engine::extensionOf(task.out),
      .writing = writing};
  return foresee(planned, shownOutput(task.out), options.estimate, job);
}

void sayWhenNothingGoes(const engine::RemoveCounts& counts, const engine::RemoveOptions& options,
                        const engine::Version& field, const std::string& scan) {
  if (counts.removed > 0) return;
  const bool no_mark =
      options.region == engine::Region::kMarked && field.reader().root().marked_children == 0;
  warn(fmt::format("{}: no sample is removed: {}", shownInput(scan),
                   no_mark             ? "none is marked"
                   : counts.spared > 0 ? "those of such a height are marked, and stay without --region all"
                                       : "none has such a height"));
}

engine::Result<Report> removeOne(const RemoveRun& options, const BatchTask& task, engine::JobControl& job) {
  const auto imported = loadScan(task.in, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const auto remove = removeOptionsOf(options.what, imported->field.grid());
  if (!remove) return tl::unexpected(remove.error());
  const auto field = countedOrNone(imported->field, std::nullopt, task.in, options.region, job);
  if (!field) return tl::unexpected(field.error());
  engine::Result<Foreseen> foreseen;
  if (memoryPlace(task.out) == nullptr)
    foreseen = foreseeRemove(options, *remove, task, *field, *imported, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  const engine::Stopwatch watch;
  const auto done = removedFrom(imported->field, *field, options.what.region, *remove, task.in, job);
  if (!done) return tl::unexpected(done.error());
  const double seconds = watch.seconds();
  sayWhenNothingGoes(done->counts, *remove, *field, task.in);
  engine::ExportOptions writing = options.writing;
  writing.original = imported->original.value_or(imported->field);
  auto known = KnownSteps::of(*imported, task, job);
  if (!known) return tl::unexpected(known.error());
  if (choosesByMarks(options.what.region) && remove->region == engine::Region::kMarked) {
    known->leftOut("marked samples that were removed: they belong to this scan");
  } else {
    if (!options.region.marks.empty()) known->leftOut("the marks of --marks: they belong to this scan");
    known->did(RecipeRemove{options.what});
  }
  known->note(writing);
  if (auto status = saveField(done->field, task.out, job, writing, task.to); !status)
    return tl::unexpected(status.error());
  return Report{{"removed", done->counts.removed},
                {"spared", done->counts.spared},
                {"no_data", engine::summarize(done->field).no_data},
                {"seconds", seconds},
                {"hash", hashOf(done->field)}};
}

engine::Result<Report> removeAll(const RemoveRun& given, engine::JobControl& job) {
  RemoveRun options = given;
  options.what.region = options.region.region;
  if (isShape(options.what.region))
    if (auto status = checkRegion(options.region); !status) return tl::unexpected(status.error());
  const auto tasks = batchTasks(options.files, {options.region.marks}, job);
  if (!tasks) return tl::unexpected(tasks.error());
  if (auto status = checkCompress(options.writing, *tasks); !status) return tl::unexpected(status.error());
  const auto one = [&](const BatchTask& task, engine::JobControl& j) { return removeOne(options, task, j); };
  if (options.files.many()) return runBatch(*tasks, job, one);
  const ProgressLine progress(job);
  return one(tasks->front(), job);
}

}  // namespace

void addRemove(Command root, Chosen& chosen) {
  auto options = std::make_shared<RemoveRun>();
  Command command = addCommand(
      root, chosen, "remove", "Remove samples by height or by mark: they become holes",
      [options](engine::JobControl& job) { return removeAll(*options, job); }, printBatch, Progress::kOwn,
      batchStatus);
  addBatchOptions(command, options->files);
  command.add({
      {.name = "--below",
       .to = &options->what.below,
       .text = "Samples lower than this height, which may be negative",
       .kind = ValueKind::kLength,
       .otherwise = "any"},
      {.name = "--above",
       .to = &options->what.above,
       .text = "Samples higher than this height; with --below those outside both",
       .kind = ValueKind::kLength,
       .otherwise = "any"},
      {.name = "--between",
       .to = &options->what.between,
       .text = "Samples between two heights, both included",
       .shown = "LOW,HIGH",
       .otherwise = "any",
       .between = ',',
       .excludes = {"--below", "--above"}},
      regionRow(options->region, "Which of these. Without heights, all of the region", "unmarked",
                removeWords()),
      {.name = "--marks",
       .to = &options->region.marks,
       .text = "Picture of marks, instead of the marks of a session",
       .kind = ValueKind::kMarks},
  });
  addEstimateOption(command, options->estimate);
  addCompressOption(command, options->writing);
  addScanOptions(command, options->reading);
  command.notes(
      "For values that stand for no data, the table around a part, dust. Heights are those that fettle info "
      "shows. All other samples keep every bit, marks and edge lines stay. It is refused to remove every "
      "sample.\n"
      "In a session the scan that it began with keeps these heights, and changes are limited from them, "
      "until "
      "the holes are filled: a filled sample is no measured one. Written to another format, what is "
      "removed is a hole like any other.");
  command.examples(
      {{"fettle remove scan.tif part.tif --below -0.2mm", "A part without the table it stands on"},
       {"fettle remove scan.tif part.tif --between 0,0", "Zeros that stand for no data"},
       {"fettle remove scan.tif clean.tif --region marked --marks marks.png", "What was marked"},
       {"fettle remove scan.tif part.tif --region unmarked --marks marks.png", "All but what was marked"},
       {"fettle remove scan.tif part.tif --region \"rectangle 1,1,3,2\"", "What lies between two corners"}});
}

}  // namespace fettle::app
