#include <memory>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/known_steps.h"
#include "app/commands/region_option.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/shards/band_work.h"
#include "app/commands/shards/list_shard.h"
#include "app/commands/shards/plan.h"
#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/streams.h"
#include "engine/formats/formats.h"

namespace fettle::app {

namespace {

struct ConvertArguments {
  BatchOptions files;
  ScanOptions reading;
  engine::ExportOptions writing;
  std::string max_error;
  std::string mesh_unit;
  bool estimate = false;
  ShardOptions shards;
};

engine::Result<Report> convertOne(const ConvertArguments& options, const BatchTask& task,
                                  engine::JobControl& job) {
  const auto imported = loadScan(task.in, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  if (MemoryPlace* place = memoryPlace(task.out)) {
    place->scan = *imported;
    return Report{{"format", ""},
                  {"from", imported->format},
                  {"hash", hashOf(imported->field)},
                  {"warnings", imported->warnings}};
  }
  engine::ExportOptions writing = options.writing;
  writing.original = imported->original;
  const auto known = KnownSteps::of(*imported, task, job);
  if (!known) return tl::unexpected(known.error());
  known->note(writing);
  if (!options.max_error.empty()) {
    const auto error = parseHeight(options.max_error, imported->field.grid(), "--max-error");
    if (!error) return tl::unexpected(error.error());
    writing.max_error = *error;
  }
  if (!options.mesh_unit.empty()) writing.mesh_unit = engine::lengthUnitFromName(options.mesh_unit);
  const PlannedWork planned{
      .field = imported->field,
      .original = imported->original ? *imported->original : imported->field,
      .steps = {},
      .out = task.out,
      .extension = isStream(task.out) ? withDot(task.to) : engine::extensionOf(task.out),
      .writing = writing};
  auto foreseen = foresee(planned, shownOutput(task.out), options.estimate, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  engine::Result<engine::Exported> written;
  const auto done = writeTo(task.out, withDot(task.to), job, [&](const std::string& file) -> engine::Status {
    written = engine::exportField(imported->field, file, writing, job);
    return written ? engine::Status{} : tl::unexpected(written.error());
  });
  if (!done) return tl::unexpected(done.error());
  if (imported->field.reader().root().marked_children != 0 && written->format != "Fettle")
    written->warnings.push_back("the marks of the session are not stored, the format has none");
  if (imported->field.lines() != nullptr && !imported->field.lines()->empty() && written->format != "Fettle")
    written->warnings.push_back(
        "the edge lines of the session are not stored, the format has none; fettle lines --out writes them");
  warnOfFilledLost(imported->field, imported->original, task.out, task.to);
  for (const std::string& warning : written->warnings) warn(shownOutput(task.out) + ": " + warning);
  return Report{{"format", written->format},
                {"from", imported->format},
                {"hash", hashOf(imported->field)},
                {"warnings", written->warnings}};
}

// What --mesh-unit says, before a file of many is written.
engine::Status checkMeshUnit(const ConvertArguments& options, const std::vector<BatchTask>& tasks) {
  if (options.mesh_unit.empty()) return {};
  if (!engine::lengthUnitFromName(options.mesh_unit))
    return engine::inputError(fmt::format("unknown unit {}", options.mesh_unit), "--mesh-unit",
                              fmt::format("take one of {}", fmt::join(engine::lengthUnitNames(), ", ")));
  for (const BatchTask& task : tasks)
    if (const std::string extension = isStream(task.out) ? withDot(task.to) : engine::extensionOf(task.out);
        !extension.empty() && extension != ".stl")
      return engine::inputError("only .stl is written in a unit that is chosen", shownOutput(task.out),
                                "write that or omit --mesh-unit: others state the unit of their numbers");
  return {};
}

// What a band of one scan is told; options that are of a whole scan are refused.
engine::Result<BandWork> convertedBandOf(const ConvertArguments& options) {
  if (options.files.many() || options.files.files.size() != 2)
    return engine::inputError("one scan is divided into bands", "IN OUT", "give a scan and a file to write");
  if (options.estimate)
    return engine::inputError("--estimate is not divided into shards", "--estimate",
                              "fettle plan says what a shard will take");
  if (!options.max_error.empty() || options.writing.mesh || !options.mesh_unit.empty())
    return engine::inputError("a mesh is made of the whole field", "--mesh", "leave shards out");
  const std::vector<BatchTask> task{
      {options.files.files[0], options.files.files[1], options.files.extension}};
  if (auto status = checkCompress(options.writing, task); !status) return tl::unexpected(status.error());
  return BandWork{.command = "convert",
                  .reading = options.reading,
                  .writing = options.writing,
                  .in = options.files.files[0],
                  .out = options.files.files[1]};
}

engine::Result<Report> convert(const ConvertArguments& options, const std::vector<std::string>& arguments,
                               engine::JobControl& job) {
  if (auto status = checkShardOptions(options.shards); !status) return tl::unexpected(status.error());
  if (options.shards.in_turn || (!options.shards.shard.empty() && !options.files.many())) {
    const auto work = convertedBandOf(options);
    if (!work) return tl::unexpected(work.error());
    const ProgressLine progress(job);
    return options.shards.in_turn ? runBandsInTurn(*work, options.shards, arguments, job)
                                  : runBand(*work, options.shards.shard, job);
  }
  const auto tasks = batchTasks(options.files, {}, job);
  if (!tasks) return tl::unexpected(tasks.error());
  if (auto status = checkCompress(options.writing, *tasks); !status) return tl::unexpected(status.error());
  if (auto status = checkMeshUnit(options, *tasks); !status) return tl::unexpected(status.error());
  const auto one = [&](const BatchTask& task, engine::JobControl& j) { return convertOne(options, task, j); };
  if (options.files.many()) {
    const auto mine = ListShard::begin(*tasks, options.shards.shard,
                                       options.estimate ? std::string() : options.files.out_dir, arguments);
    if (!mine) return tl::unexpected(mine.error());
    auto report = runBatch(mine->tasks(), job, one);
    if (report)
      if (auto status = mine->keep(*report); !status) return tl::unexpected(status.error());
    return report;
  }
  const ProgressLine progress(job);
  return one(tasks->front(), job);
}

void addConvertRows(Command command, const std::shared_ptr<ConvertArguments>& options) {
  addBatchOptions(command, options->files);
  command.add(
      {
          {.name = "--mesh",
           .to = &options->writing.mesh,
           .text = "PLY: triangles instead of points (STL always)"},
          {.name = "--max-error",
           .to = &options->max_error,
           .text = "Mesh: as few triangles as possible with every sample within this height",
           .kind = ValueKind::kLength},
          {.name = "--mesh-unit",
           .to = &options->mesh_unit,
           .text = fmt::format("STL: unit of its numbers, which CAD programs take for mm: {}; numbers in "
                               "another unit than the scan's are rounded by up to 6e-8 of them",
                               fmt::join(engine::lengthUnitNames(), ", ")),
           .proposed = engine::lengthUnitNames(),
           .otherwise = "the scan's"},
          {.name = "--ascii", .to = &options->writing.ascii, .text = "SDF: as text instead of binary"},
          {.name = "--cloud-optimised",
           .to = &options->writing.cloud_optimised,
           .text = "TIFF: laid out for reading parts over a network, with overviews"},
      },
      kWriting);
  addCompressOption(command, options->writing);
  addScanOptions(command, options->reading);
}

}  // namespace

void addConvert(Command root, Chosen& chosen) {
  auto options = std::make_shared<ConvertArguments>();
  Command command = addCommand(
      root, chosen, "convert", "Write scans in another format, named by the extension",
      [options, &chosen](engine::JobControl& job) { return convert(*options, chosen.arguments, job); },
      printBatch, Progress::kOwn, batchStatus);
  addConvertRows(command, options);
  addEstimateOption(command, options->estimate);
  addShardOptions(command, options->shards);
  command.examples({{"fettle convert scan.tif scan.stl --max-error 10um",
                     "A mesh with as few triangles as that error allows"},
                    {"fettle convert scan.tif scan.stl --mesh-unit mm",
                     "A mesh in mm, as CAD programs expect it, whatever the scan's unit"},
                    {"fettle convert scan.tif other.tif --out-dir packed --to tif --compress zstd",
                     "Several scans, packed, into a folder"}});
}

void addPlanConvert(Command plan, Chosen& chosen) {
  auto options = std::make_shared<ConvertArguments>();
  auto shards = std::make_shared<PlanOptions>();
  Command command = addCommand(
      plan, chosen, "convert", "Plan writing one scan in another format in shards",
      [options, shards, &chosen](engine::JobControl& job) -> engine::Result<Report> {
        const auto work = convertedBandOf(*options);
        if (!work) return tl::unexpected(work.error());
        const auto planned = planBands(*work, *shards, shardArguments(chosen.arguments), {}, job);
        if (!planned) return tl::unexpected(planned.error());
        return reportOf(*planned);
      },
      printPlan);
  addPlanOptions(command, *shards);
  addConvertRows(command, options);
}

}  // namespace fettle::app
