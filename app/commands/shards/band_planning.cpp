#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "app/commands/shards/band_input.h"
#include "app/commands/shards/band_work.h"
#include "app/commands/shards/shard_folder.h"
#include "app/commands/typed_values.h"
#include "engine/base/memory.h"
#include "engine/base/stopwatch.h"
#include "engine/field/piece.h"
#include "engine/field/tile.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/noise_range.h"
#include "engine/formats/formats.h"
#include "engine/inspect/noise.h"
#include "engine/io/files/atomic_file.h"
#include "engine/io/files/input_file.h"
#include "engine/resume/work_identity.h"
#include "engine/shard/bands.h"

namespace fettle::app {

namespace {

using engine::RowSpan;

std::string folderOf(const std::string& path) {
  const std::string parent = std::filesystem::path(path).parent_path().string();
  return parent.empty() ? "." : parent;
}

// Threads that a shard takes: of several on a machine, which may not be this one, each has one, unless it was told otherwise.
int threadsOf(const BandWork& work, bool alone) {
  const int typed = work.spec ? work.spec->threads : 0;
  if (!alone) return std::max(typed, 1);
  return typed != 0 ? std::min(typed, usableCores()) : usableCores();
}

// Whether an earlier plan for the same work, in other bands perhaps, is one to go on with.
bool continues(const ShardPlan& plan, const ShardPlan& earlier, std::uint64_t most_memory) {
  ShardPlan as_earlier = plan;
  as_earlier.shards = earlier.shards;
  as_earlier.one_file = earlier.one_file;
  return as_earlier.id() == earlier.id() && earlier.memory_bytes <= most_memory;
}

// The range of the noise: of the whole field, read by rows where it can be.
engine::Result<engine::FilterSpec> withRange(const BandWork& work, engine::FilterSpec spec,
                                             const engine::Grid& grid, const std::optional<BandInput>& whole,
                                             std::uint64_t memory, engine::JobControl& job) {
  if (!work.range_sigma.empty()) {
    const auto range = parseHeight(work.range_sigma, grid, "--range-sigma");
    if (!range) return tl::unexpected(range.error());
    spec.range_sigma = *range;
    if (auto status = engine::validate(spec); !status) return tl::unexpected(status.error());
    return spec;
  }
  if (whole) return engine::withMeasuredRange(spec, whole->input, job);
  if (!engine::hasRange(spec.kind)) return spec;
  const std::uint64_t room = (memory != 0 ? memory : engine::availableMemory() / 2) / 2;
  const double rows = static_cast<double>(room) / (5.0 * grid.width) / engine::kTileSide;
  const auto tiles = static_cast<std::int32_t>(std::clamp(rows, 1.0, 4096.0));
  RowSpan last;
  engine::Version held;
  const auto noise = engine::estimateNoiseByRows(
      grid,
      [&](RowSpan span, engine::JobControl& part) -> engine::Result<engine::Version> {
        // A field that fits is read once.
        if (span == last) return held;
        held = {};
        auto band = loadBand(
            work, [&](const engine::Grid&) { return span; }, part);
        if (!band) return tl::unexpected(band.error());
        last = span;
        held = band->field.input;
        return held;
      },
      tiles* engine::kTileSide, job);
  if (!noise) return tl::unexpected(noise.error());
  return engine::withRangeOf(spec, *noise);
}

// Seconds that the largest shard takes on this machine, from a piece of the middle: the filter, and some 200 MB/s of disk.
engine::Result<double> foreseenSeconds(const BandWork& work, const ShardPlan& plan, const engine::Grid& grid,
                                       const RowSpan& own, const RowSpan& read, engine::JobControl& job) {
  constexpr std::int32_t kPieceColumns = 512, kPieceRows = 512;
  constexpr double kBytesPerSecond = 200e6;
  const double bytes = 4.0 * grid.width * (static_cast<double>(read.count) + own.count);
  double seconds = bytes / kBytesPerSecond;
  auto spec = plannedSpec(work, plan);
  if (!spec) return seconds;
  spec->threads = plan.threads;
  const std::int32_t rows = std::min(kPieceRows, grid.height);
  const RowSpan middle{(grid.height - rows) / 2 / engine::kTileSide * engine::kTileSide, rows};
  auto band = loadBand(
      work, [&](const engine::Grid&) { return middle; }, job);
  if (!band) return tl::unexpected(band.error());
  const std::int32_t columns = std::min(kPieceColumns, grid.width);
  const engine::Version piece =
      engine::pieceOf(band->field.input, (grid.width - columns) / 2, 0, columns, rows);
  if (auto valid = engine::validate(*spec, piece.grid()); !valid) return tl::unexpected(valid.error());
  const engine::Stopwatch watch;
  engine::JobControl part = engine::JobControl::partOf(job);
  const auto done = engine::applyFilter(piece, piece, *spec, part);
  if (!done) return tl::unexpected(done.error());
  const double share = static_cast<double>(grid.width) * read.count / (static_cast<double>(columns) * rows);
  return seconds + watch.seconds() * share;
}

// The plan without its result's places.
engine::Result<ShardPlan> drawUp(const BandWork& work, const PlanOptions& options,
                                 const std::vector<std::string>& arguments,
                                 const std::optional<TurnMemory>& memory, const ShardPlan* earlier,
                                 engine::Grid& grid, engine::JobControl& job) {
  const auto import = importOptions(work.reading);
  if (!import) return tl::unexpected(import.error());
  std::optional<BandInput> whole;
  std::optional<engine::Grid> from_header;
  if (!hasCompanions(work)) {
    auto found = engine::importGrid(work.in, *import);
    if (!found) return tl::unexpected(found.error());
    from_header = *std::move(found);
  }
  if (!from_header) {
    if (memory)
      return engine::inputError("marks, lines, an original and formats other than TIFF are read as a whole",
                                work.in, "convert it to .tif, and leave --shards-in-turn out for the others");
    auto read = wholeOf(work, job);
    if (!read) return tl::unexpected(read.error());
    whole = *std::move(read);
  }
  grid = from_header ? *from_header : whole->input.grid();
  ShardPlan plan;
  plan.command = work.command;
  plan.arguments = arguments;
  std::error_code ignored;
  plan.folder = std::filesystem::current_path(ignored).string();
  plan.settings = settingsOf(work);
  plan.in = work.in;
  plan.out = work.out;
  const auto print = printOf(work.in);
  if (!print) return tl::unexpected(print.error());
  plan.in_print = *print;
  plan.in_bytes = std::filesystem::file_size(work.in, ignored);
  plan.width = grid.width;
  plan.height = grid.height;
  plan.lines = whole && whole->input.lines() != nullptr;
  plan.unit = grid.height_unit.name;
  plan.revision = engine::kFilterRevision;
  plan.threads = threadsOf(work, memory.has_value());
  if (work.spec) {
    const engine::Filter& filter = engine::filterOf(work.spec->kind);
    if (options.shards != 1 && engine::needsWholeField(filter))
      return engine::inputError(
          fmt::format("a result of {} depends on the whole field, no band of it can be worked out alone",
                      filter.word),
          "--filter", "run it on one machine without shards, or with --out-dir share out whole scans");
    if (auto valid = engine::validate(*work.spec, grid);
        !valid && !(filter.range_sigma.exists() && valid.error().where == "range-sigma"))
      return tl::unexpected(valid.error());
    if (!work.max_change.empty()) {
      const auto limit = parseHeight(work.max_change, grid, "--max-change");
      if (!limit) return tl::unexpected(limit.error());
      plan.max_change = *limit;
    }
    const auto ready = withRange(work, *work.spec, grid, whole, memory ? memory->most : 0, job);
    if (!ready) return tl::unexpected(ready.error());
    if (filter.range_sigma.exists()) plan.range_sigma = ready->range_sigma;
  }
  const auto spec = plannedSpec(work, plan);
  plan.halo = spec ? engine::reachOf(*spec, grid, plan.lines) : 0;
  if (!memory) {
    plan.shards = options.shards;
  } else if (earlier != nullptr && continues(plan, *earlier, memory->keeps)) {
    // What is available differs from one moment to the next: other bands would lose those that are done.
    plan.shards = earlier->shards;
  } else {
    plan.shards = engine::fewestShards(grid, spec, plan.lines, plan.threads, memory->most);
    if (plan.shards == 0) {
      const RowSpan least{0, std::min(engine::kTileSide, grid.height)};
      const double needed = static_cast<double>(engine::bandMemory(
          grid, least, engine::rowsRead(grid, least, spec, plan.lines), spec, plan.threads));
      return engine::inputError(
          fmt::format("a band of one row of tiles takes {:.0f} MB and more", std::ceil(1.5 * needed / 1e6)),
          "--memory", "give more memory, or fewer --threads");
    }
  }
  // The largest: one that has neighbours on both sides.
  const int middle = plan.shards / 2 + 1;
  const RowSpan own = engine::bandOf(grid, {middle, plan.shards});
  const RowSpan read = engine::rowsRead(grid, own, spec, plan.lines);
  plan.memory_bytes = engine::bandMemory(grid, own, read, spec, plan.threads);
  // Such a shard has the whole in memory beside its band.
  if (whole)
    plan.memory_bytes += static_cast<std::uint64_t>(
        engine::kFieldBytes * static_cast<double>(grid.samples()) * (work.original.empty() ? 1.0 : 2.0));
  if (!memory) {
    const auto seconds = foreseenSeconds(work, plan, grid, own, read, job);
    if (!seconds) return tl::unexpected(seconds.error());
    plan.seconds = *seconds;
  }
  return plan;
}

engine::Status makeFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directory(path, error);
  if (error) return engine::writeError(path, error.value());
  return {};
}

}  // namespace

engine::Result<ShardPlan> planBands(const BandWork& work, const PlanOptions& options,
                                    const std::vector<std::string>& arguments,
                                    const std::optional<TurnMemory>& memory, engine::JobControl& job) {
  if (auto status = checkBandFiles(work, job); !status) return tl::unexpected(status.error());
  const bool plain = writesPlainTiff(work.out, settingsOf(work));
  if (options.result == "one-file" && !plain)
    return engine::inputError("shards write into one file where it is a TIFF without compression", work.out,
                              "leave --result out");
  if (memory && !plain)
    return engine::inputError(
        "only a TIFF without compression is written row by row, others are put together in memory as a whole",
        work.out, "write a .tif without --compress, and convert it where the memory is: fettle convert");
  const ShardFolder folder(work.out);
  std::error_code error;
  std::optional<ShardPlan> earlier;
  const bool planned_before = std::filesystem::exists(folder.plan(), error);
  if (planned_before)
    if (auto found = readPlan(folder.plan())) earlier = *std::move(found);
  // Shards that somebody else planned are no bands to go on with.
  const bool own = memory && earlier && earlier->inTurn();
  engine::Grid grid;
  auto plan = drawUp(work, options, arguments, memory, own ? &*earlier : nullptr, grid, job);
  if (!plan) return plan;
  const bool one_file =
      options.result == "one-file" ||
      (options.result == "auto" && plain && (memory || engine::keepsBytesApart(folderOf(work.out))));
  if (planned_before) {
    if (earlier)
      plan->one_file = one_file == earlier->one_file.has_value() ? earlier->one_file : std::nullopt;
    const bool same = earlier && earlier->id() == plan->id() && earlier->inTurn() == memory.has_value();
    // Once gathered the file that the shards wrote into is gone: the same plan begins again.
    if (same && (!earlier->one_file || std::filesystem::exists(folder.whole(), error))) return *earlier;
    if (!same && !own && !options.again)
      return engine::inputError("there is another plan for this output", folder.plan(),
                                memory ? "gather its shards, or remove the folder"
                                       : "gather its shards, remove the folder, or give --again");
    std::filesystem::remove_all(folder.path(), error);
  }
  if (auto status = makeFolder(folder.path()); !status) return tl::unexpected(status.error());
  plan->one_file.reset();
  if (one_file) {
    const auto layout = engine::createPlainTiff(grid, folder.whole());
    if (!layout) {
      std::filesystem::remove(folder.path(), error);  // where nothing is in it
      return tl::unexpected(layout.error());
    }
    plan->one_file = *layout;
  }
  Report file{{"schema", planSchema(plan->command)}};
  file.update(reportOf(*plan));
  const std::string text = file.dump(1, ' ', false, Report::error_handler_t::replace) + "\n";
  if (auto status = engine::writeFileAtomically(folder.plan(), text); !status)
    return tl::unexpected(status.error());
  return plan;
}

}  // namespace fettle::app
