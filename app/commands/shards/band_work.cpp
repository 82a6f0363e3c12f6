#include "app/commands/shards/band_work.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "app/commands/original_scan.h"
#include "app/commands/output_checks.h"
#include "app/commands/scan_files.h"
#include "app/commands/shards/gathering.h"
#include "app/commands/shards/launcher.h"
#include "app/commands/shards/shard_folder.h"
#include "app/commands/shards/shard_note.h"
#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/open_document.h"
#include "app/work/streams.h"
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
#include "engine/shard/band_filter.h"
#include "engine/shard/bands.h"

namespace fettle::app {

namespace {

using engine::RowSpan;

// Rows of the input as the command has them, and of what a limit is measured against.
struct BandInput {
  engine::Version input, original;
};

bool hasCompanions(const BandWork& work) {
  return !work.keep.empty() || !work.only.empty() || !work.lines.empty() || !work.original.empty();
}

// The field as the command has it: as a whole, because its marks, lines or original are of the whole.
engine::Result<BandInput> wholeOf(const BandWork& work, engine::JobControl& job) {
  auto imported = loadScan(work.in, work.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  if (imported->field.seenOf() != nullptr)
    return engine::inputError("a form lies over the session, which is of the whole field", work.in,
                              "bake it first: fettle level --layer bake");
  auto original = originalOf(*imported, work.original, work.reading, job);
  if (!original) return tl::unexpected(original.error());
  auto marked = withMarks(imported->field, work.only.empty() ? work.keep : work.only, job);
  if (!marked) return tl::unexpected(marked.error());
  auto lined = withLines(*marked, work.lines, job);
  if (!lined) return tl::unexpected(lined.error());
  return BandInput{*std::move(lined), *std::move(original)};
}

engine::Version rowsWithSign(const engine::Version& field, const engine::Version& like, const RowSpan& rows) {
  const bool same_sign = field.reader().sign() == like.reader().sign();
  return engine::rowsOf(same_sign ? field : field.inverted(), rows.first, rows.count);
}

// Some rows of it, which `rowsIn` names when the grid is known.
struct LoadedBand {
  BandInput field;
  RowSpan rows;
  engine::Grid whole;
};

engine::Result<LoadedBand> loadBand(const BandWork& work, const auto& rowsIn, engine::JobControl& job) {
  const auto import = importOptions(work.reading);
  if (!import) return tl::unexpected(import.error());
  if (!hasCompanions(work)) {
    const auto grid = engine::importGrid(work.in, *import);
    if (!grid) return tl::unexpected(grid.error());
    if (*grid) {
      const RowSpan rows = rowsIn(**grid);
      auto band = engine::importRows(work.in, *import, rows.first, rows.count, job);
      if (!band) return tl::unexpected(band.error());
      for (const std::string& warning : band->warnings) warn(fmt::format("{}: {}", work.in, warning));
      return LoadedBand{{band->field, band->field}, rows, **grid};
    }
  }
  auto whole = wholeOf(work, job);
  if (!whole) return tl::unexpected(whole.error());
  const RowSpan rows = rowsIn(whole->input.grid());
  engine::Version original = rowsWithSign(whole->original, whole->input, rows);
  return LoadedBand{
      {engine::rowsOf(whole->input, rows.first, rows.count), std::move(original)}, rows, whole->input.grid()};
}

// What every shard must be told alike.
Report settingsOf(const BandWork& work) {
  Report settings{{"in", work.in}, {"out", work.out}};
  if (work.spec) {
    const engine::FilterSpec& spec = *work.spec;
    settings["filter"] = engine::name(spec.kind);
    settings["window"] = spec.window;
    settings["sigma"] = spec.sigma;
    settings["nesting"] = spec.nesting_mm;
    settings["element"] = engine::kElementWords[static_cast<std::size_t>(spec.element)];
    settings["passes"] = spec.passes;
  }
  const std::pair<const char*, const std::string&> texts[] = {{"range-sigma", work.range_sigma},
                                                              {"max-change", work.max_change},
                                                              {"keep", work.keep},
                                                              {"only", work.only},
                                                              {"lines", work.lines},
                                                              {"original", work.original}};
  for (const auto& [word, text] : texts)
    if (!text.empty()) settings[word] = text;
  if (const std::string reading = scanOptionsText(work.reading); !reading.empty())
    settings["reading"] = reading;
  if (work.writing.tiff_compression) settings["compress"] = static_cast<int>(*work.writing.tiff_compression);
  if (work.writing.cloud_optimised) settings["cloud-optimised"] = true;
  if (work.writing.ascii) settings["ascii"] = true;
  return settings;
}

std::string folderOf(const std::string& path) {
  const std::string parent = std::filesystem::path(path).parent_path().string();
  return parent.empty() ? "." : parent;
}

engine::Status checkBandFiles(const BandWork& work, engine::JobControl& job) {
  if (isStream(work.in) || memoryPlace(work.in) != nullptr)
    return engine::inputError("shards read a file", shownInput(work.in), "name one");
  if (isStream(work.out) || memoryPlace(work.out) != nullptr)
    return engine::inputError("shards write a file", shownOutput(work.out), "name one");
  if (isSessionPath(work.out))
    return engine::inputError("a session cannot be written in shards", work.out, "name a .tif");
  if (work.writing.mesh || work.writing.max_error)
    return engine::inputError("a mesh is made of the whole field", work.out, "leave shards out");
  return checkOutputs({{work.out, OutputKind::kField, {}}},
                      {work.in, work.keep, work.only, work.lines, work.original}, Replacing::kNoWork, job);
}

bool isPlainTiff(const BandWork& work) {
  const std::string extension = engine::extensionOf(work.out);
  return (extension == ".tif" || extension == ".tiff") && !work.writing.cloud_optimised &&
         work.writing.tiff_compression.value_or(engine::TiffCompression::kNone) ==
             engine::TiffCompression::kNone;
}

int threadsOf(const BandWork& work) {
  const int cores = usableCores();
  return !work.spec || work.spec->threads == 0 ? cores : std::min(work.spec->threads, cores);
}

// The spec with its range and limit, as planned.
std::optional<engine::FilterSpec> plannedSpec(const BandWork& work, const ShardPlan& plan) {
  std::optional<engine::FilterSpec> spec = work.spec;
  if (spec && plan.range_sigma) spec->range_sigma = *plan.range_sigma;
  if (spec) spec->max_change = plan.max_change;
  return spec;
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
  const auto spec = plannedSpec(work, plan);
  if (!spec) return seconds;
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
engine::Result<ShardPlan> drawUp(const BandWork& work, int shards, const std::vector<std::string>& arguments,
                                 std::uint64_t memory, engine::Grid& grid, engine::JobControl& job) {
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
    if (memory != 0)
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
  if (work.spec) {
    const engine::Filter& filter = engine::filterOf(work.spec->kind);
    if (shards != 1 && engine::needsWholeField(filter))
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
    const auto ready = withRange(work, *work.spec, grid, whole, memory, job);
    if (!ready) return tl::unexpected(ready.error());
    if (filter.range_sigma.exists()) plan.range_sigma = ready->range_sigma;
  }
  const auto spec = plannedSpec(work, plan);
  if (shards == 0) {
    plan.shards = engine::fewestShards(grid, spec, plan.lines, threadsOf(work), memory);
    if (plan.shards == 0) {
      const RowSpan least{0, std::min(engine::kTileSide, grid.height)};
      const double needed = static_cast<double>(engine::bandMemory(
          grid, least, engine::rowsRead(grid, least, spec, plan.lines), spec, threadsOf(work)));
      return engine::inputError(
          fmt::format("a band of one row of tiles takes {:.0f} MB and more", std::ceil(1.5 * needed / 1e6)),
          "--memory", "give more memory, or fewer --threads");
    }
  } else {
    plan.shards = shards;
  }
  // The largest: one that has neighbours on both sides.
  const int middle = plan.shards / 2 + 1;
  const RowSpan own = engine::bandOf(grid, {middle, plan.shards});
  const RowSpan read = engine::rowsRead(grid, own, spec, plan.lines);
  plan.halo = spec ? engine::reachOf(*spec, grid, plan.lines) : 0;
  plan.memory_bytes = engine::bandMemory(grid, own, read, spec, threadsOf(work));
  if (memory == 0) {
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

// Writes the rows of one shard to their place, or to a file of its own that appears whole.
class BandOutput {
 public:
  static engine::Result<BandOutput> open(const ShardFolder& folder, const ShardPlan& plan, int number,
                                         engine::Grid grid, const RowSpan& own) {
    if (plan.one_file) {
      auto rows = engine::PlainRows::open(folder.whole(), *plan.one_file);
      if (!rows) return tl::unexpected(rows.error());
      return BandOutput(*std::move(rows), 0, {}, {});
    }
    grid.origin_y += own.first * grid.spacing_y;
    grid.height = own.count;
    // A name of this process: one that was killed leaves another.
    const std::string part =
        fmt::format("{}/part-{}-{}-{}.tif", folder.path(), number, hostName(), ::getpid());
    const auto layout = engine::createPlainTiff(grid, part);
    if (!layout) return tl::unexpected(layout.error());
    auto rows = engine::PlainRows::open(part, *layout);
    if (!rows) return tl::unexpected(rows.error());
    return BandOutput(*std::move(rows), own.first, part, folder.rows(number));
  }
  BandOutput(BandOutput&& other) noexcept
      : rows_(std::move(other.rows_)),
        first_(other.first_),
        part_(std::exchange(other.part_, {})),
        final_(std::move(other.final_)) {}
  BandOutput& operator=(BandOutput&&) = delete;
  ~BandOutput() {
    std::error_code ignored;
    if (!part_.empty()) std::filesystem::remove(part_, ignored);
  }

  engine::Status write(std::int32_t row, std::int32_t rows, const float* heights) {
    return rows_.write(row - first_, rows, heights);
  }

  engine::Status commit() {
    if (auto status = rows_.flush(); !status) return status;
    if (part_.empty()) return {};
    std::error_code error;
    std::filesystem::rename(part_, final_, error);
    if (error) return engine::writeError(final_, error.value());
    part_.clear();
    return {};
  }

 private:
  BandOutput(engine::PlainRows rows, std::int32_t first, std::string part, std::string final_path)
      : rows_(std::move(rows)), first_(first), part_(std::move(part)), final_(std::move(final_path)) {}

  engine::PlainRows rows_;
  std::int32_t first_;
  std::string part_, final_;  // empty: rows of the file of all
};

engine::Status checkPlanned(const BandWork& work, const ShardPlan& plan) {
  const Report mine = settingsOf(work);
  for (const Report& settings : {plan.settings, mine})
    for (const auto& [word, value] : settings.items()) {
      const Report planned = plan.settings.value(word, Report()), now = mine.value(word, Report());
      if (planned != now)
        return engine::inputError(
            fmt::format("the work was planned with {} {}, not with {}", word,
                        planned.is_null() ? "none" : planned.dump(), now.is_null() ? "none" : now.dump()),
            fmt::format("--{}", word), "give all shards the options of the plan, or plan again");
    }
  const auto print = printOf(work.in);
  if (!print) return tl::unexpected(print.error());
  if (*print != plan.in_print)
    return engine::inputError("this is not the file that the work was planned for", work.in,
                              "copy it again, or plan again");
  return {};
}

engine::Result<Report> runPlanned(const BandWork& work, const ShardPlan& plan, int number,
                                  engine::JobControl& job) {
  const ShardFolder folder(plan.out);
  if (Report earlier = reportOfShard(folder, plan, number); !earlier.is_null()) {
    earlier["finished_before"] = true;
    return earlier;
  }
  const ShardNote note(folder.note(number), job);
  const engine::Stopwatch watch;
  engine::Grid sides;
  sides.width = plan.width;
  sides.height = plan.height;
  const RowSpan own = engine::bandOf(sides, {number, plan.shards});
  const auto spec = plannedSpec(work, plan);
  Report report{{"shard", number},
                {"shards", plan.shards},
                {"plan", plan.id()},
                {"row", own.first},
                {"rows", own.count}};
  if (spec) report["filter"] = engine::name(spec->kind);
  double read_seconds = 0.0, work_seconds = 0.0;
  engine::BandReport done;
  std::int32_t read_rows = 0;
  if (own.count > 0) {
    const auto band = loadBand(
        work, [&](const engine::Grid& grid) { return engine::rowsRead(grid, own, spec, plan.lines); }, job);
    if (!band) return tl::unexpected(band.error());
    if (band->whole.width != plan.width || band->whole.height != plan.height)
      return engine::inputError("the scan has another size than planned", work.in, "plan again");
    read_rows = band->rows.count;
    read_seconds = watch.seconds();
    auto output = BandOutput::open(folder, plan, number, band->whole, own);
    if (!output) return tl::unexpected(output.error());
    const auto made = engine::filterBand(
        band->field.input, band->field.original, spec ? &*spec : nullptr, band->rows, own,
        [&](std::int32_t row, std::int32_t rows, const float* heights) {
          return output->write(row, rows, heights);
        },
        job);
    if (!made) return tl::unexpected(made.error());
    done = *made;
    work_seconds = watch.seconds() - read_seconds;
    if (auto status = output->commit(); !status) return tl::unexpected(status.error());
  }
  report.update({{"read_rows", read_rows},
                 {"unit", plan.unit},
                 {"samples", done.samples},
                 {"no_data", done.holes},
                 {"changed", done.changed},
                 {"max_change", done.max_change},
                 {"squares", done.squares},
                 {"hash", fmt::format("{:016x}", done.hash)},
                 {"read_seconds", read_seconds},
                 {"work_seconds", work_seconds},
                 {"seconds", watch.seconds()},
                 {"peak_memory_bytes", engine::residentMemory().peak},
                 {"host", hostName()}});
  Report file{{"schema", fmt::format("fettle.{}/1", plan.command)}};
  file.update(report);
  const std::string text = file.dump(1, ' ', false, Report::error_handler_t::replace) + "\n";
  if (auto status = engine::writeFileAtomically(folder.done(number), text); !status)
    return tl::unexpected(status.error());
  return report;
}

}  // namespace

engine::Result<ShardPlan> planBands(const BandWork& work, const PlanOptions& options,
                                    const std::vector<std::string>& arguments, std::uint64_t memory,
                                    engine::JobControl& job) {
  if (auto status = checkBandFiles(work, job); !status) return tl::unexpected(status.error());
  const bool plain = isPlainTiff(work);
  if (options.result == "one-file" && !plain)
    return engine::inputError("shards write into one file where it is a TIFF without compression", work.out,
                              "leave --result out");
  engine::Grid grid;
  auto plan = drawUp(work, options.shards, arguments, memory, grid, job);
  if (!plan) return plan;
  const bool one_file =
      options.result == "one-file" ||
      (options.result == "auto" && plain && (memory != 0 || engine::keepsBytesApart(folderOf(work.out))));
  const ShardFolder folder(work.out);
  std::error_code error;
  if (std::filesystem::exists(folder.plan(), error)) {
    auto earlier = readPlan(folder.plan());
    if (earlier)
      plan->one_file = one_file == earlier->one_file.has_value() ? earlier->one_file : std::nullopt;
    const bool same = earlier && earlier->id() == plan->id();
    // Once gathered the file that the shards wrote into is gone: the same plan begins again.
    if (same && (!earlier->one_file || std::filesystem::exists(folder.whole(), error))) return earlier;
    if (!same && !options.again)
      return engine::inputError("there is another plan for this output", folder.plan(),
                                "gather its shards, remove the folder, or give --again");
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

engine::Result<Report> runBand(const BandWork& work, const std::string& shard, engine::JobControl& job) {
  if (auto status = checkBandFiles(work, job); !status) return tl::unexpected(status.error());
  const auto plan = readPlan(ShardFolder(work.out).plan());
  if (!plan) return tl::unexpected(plan.error());
  const auto chosen = parseShard(shard, plan->shards, variableOfProcess);
  if (!chosen) return tl::unexpected(chosen.error());
  if (auto status = checkPlanned(work, *plan); !status) return tl::unexpected(status.error());
  return runPlanned(work, *plan, chosen->number, job);
}

engine::Result<Report> runBandsInTurn(const BandWork& work, const ShardOptions& options,
                                      const std::vector<std::string>& arguments, engine::JobControl& job) {
  std::uint64_t memory = engine::availableMemory() / 2;
  if (!options.memory.empty()) {
    const auto given = parseMemory(options.memory);
    if (!given) return tl::unexpected(given.error());
    memory = *given;
  }
  // What an earlier run of the same command left counts; with another memory it has other bands, and begins again. Shards that
  // somebody planned are not removed.
  const ShardFolder folder(work.out);
  const auto earlier = readPlan(folder.plan());
  const bool own =
      earlier && std::ranges::find(earlier->arguments, "--shards-in-turn") != earlier->arguments.end();
  const std::vector<std::string> words(arguments.begin() + (arguments.empty() ? 0 : 1), arguments.end());
  auto plan = planBands(work, {.shards = 0, .result = "auto", .again = own}, words, memory, job);
  if (!plan) return tl::unexpected(plan.error());
  std::uint64_t peak = 0;
  int kept = 0;
  for (int k = 1; k <= plan->shards; ++k) {
    const auto done = runPlanned(work, *plan, k, job);
    if (!done) {
      engine::Error error = done.error();
      error.remedy += fmt::format("{}the same command continues with what is done in {}",
                                  error.remedy.empty() ? "" : ", ", folder.path());
      return tl::unexpected(error);
    }
    kept += done->contains("finished_before") ? 1 : 0;
    // Each band's own memory counts, not what the heap holds of earlier ones.
    engine::releaseFreeMemory();
    peak = std::max(peak, engine::residentMemory().peak);
  }
  auto report = gatherBands(work.out, {}, job);
  if (!report) return report;
  (*report)["bands"] = plan->shards;
  (*report)["bands_kept"] = kept;
  (*report)["peak_memory_bytes"] = std::max(peak, engine::residentMemory().peak);
  return report;
}

}  // namespace fettle::app
