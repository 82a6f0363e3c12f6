#include "app/work/work_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "app/terminal.h"
#include "app/work/streams.h"
#include "engine/base/memory.h"
#include "engine/base/stopwatch.h"
#include "engine/field/piece.h"
#include "engine/field/tile.h"
#include "engine/field/tile_store.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/work_sample.h"
#include "engine/formats/formats.h"
#include "engine/io/mesh/surface_mesh.h"

namespace fettle::app {

namespace {

// [bytes] on the disk, [s], and [bytes] of memory beside the samples, of writing samples.
struct WritingCost {
  double bytes = 0.0, seconds = 0.0, memory = 0.0;
};

// The nearest folder of a path that exists.
std::filesystem::path folderFor(const std::string& out) {
  std::error_code error;
  std::filesystem::path folder = std::filesystem::absolute(out, error).parent_path();
  while (folder.has_relative_path() && !std::filesystem::is_directory(folder, error))
    folder = folder.parent_path();
  return folder;
}

// The square of at most `side` samples from a place of the field on.
engine::SampleRect squareAt(const engine::Grid& grid, std::int32_t column, std::int32_t row,
                            std::int32_t side) {
  const std::int32_t columns = std::min(side, grid.width), rows = std::min(side, grid.height);
  return {std::clamp(column, 0, grid.width - columns), std::clamp(row, 0, grid.height - rows), columns, rows};
}

engine::Version pieceAt(const engine::Version& field, const engine::SampleRect& at) {
  return engine::pieceOf(field, at.column, at.row, at.columns, at.rows);
}

// Pieces of the result, each twice as long as the one before; seconds that they took, where they were worked out.
struct Pieces {
  std::array<engine::SampleRect, 3> at;
  std::array<engine::Version, 3> made;
  std::array<std::optional<engine::Version>, 3> originals;  // where the work makes others of them
  std::array<double, 3> seconds = {};
  std::array<double, 3> memory =
      {};  // [bytes] that they took beside what was there and the pieces themselves
  std::array<double, 3> amounts = {};  // of the work in them, and
  double all = 0.0;                    // in the field

  [[nodiscard]] std::array<double, 3> samples() const {
    std::array<double, 3> counts = {};
    for (int i = 0; i < 3; ++i) counts[i] = static_cast<double>(at[i].columns) * at[i].rows;
    return counts;
  }
  [[nodiscard]] std::array<double, 3> madeSamples() const {
    std::array<double, 3> counts = {};
    for (int i = 0; i < 3; ++i) counts[i] = static_cast<double>(made[i].grid().samples());
    return counts;
  }
};

// A cost of so many samples, by the costs of pieces of `samples`: what two pieces have in common is there once.
double ofAll(double all, int few, int many, const std::array<double, 3>& samples,
             const std::array<double, 3>& cost) {
  if (samples[many] <= samples[few]) return cost[many] / samples[many] * all;
  const double each = std::max(0.0, (cost[many] - cost[few]) / (samples[many] - samples[few]));
  return cost[many] + each * (all - samples[many]);
}

// Memory of so many samples: as much more for each doubling of the side as the last one took, at most in proportion to the
// samples. What is taken row by row grows with the side alone.
double memoryOfAll(double all, const std::array<double, 3>& samples, const std::array<double, 3>& memory) {
  if (memory[1] <= 0.0 || memory[2] <= memory[1] || samples[2] <= samples[1]) return memory[2];
  const double power = std::min(1.0, std::log(memory[2] / memory[1]) / std::log(samples[2] / samples[1]));
  return memory[2] * std::pow(std::max(1.0, all / samples[2]), power);
}

// The error of a sample as one of the file that it is a sample of: the user has named no other.
tl::unexpected<engine::Error> ofOutput(engine::Error error, const PlannedWork& work,
                                       const ScratchFolder& folder) {
  if (error.where.starts_with(folder.path())) error.where = shownOutput(work.out);
  return tl::unexpected(std::move(error));
}

engine::Result<WritingCost> costOf(const PlannedWork& work, const engine::Version& piece,
                                   const engine::SampleRect& at,
                                   const std::optional<engine::Version>& original,
                                   const ScratchFolder& folder, engine::JobControl& job) {
  engine::ExportOptions writing = work.writing;
  if (writing.original) writing.original = original ? *original : pieceAt(work.original, at);
  const std::string path = fmt::format("{}/{}{}", folder.path(), at.columns, work.extension);
  const std::uint64_t before = engine::residentMemory().now;
  const bool peak_known = engine::resetPeak();
  const engine::Stopwatch watch;
  if (work.write) {
    if (auto written = work.write(piece, path, job); !written) return ofOutput(written.error(), work, folder);
  } else if (const auto written = engine::exportField(piece, path, writing, job); !written) {
    return ofOutput(written.error(), work, folder);
  }
  WritingCost cost{0.0, watch.seconds()};
  if (const std::uint64_t peak = engine::residentMemory().peak; peak_known && peak > before)
    cost.memory = static_cast<double>(peak - before);
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path(), error)) {
    const auto bytes = entry.file_size(error);
    if (!error) cost.bytes += static_cast<double>(bytes);
    std::filesystem::remove(entry.path(), error);
  }
  return cost;
}

// The mean disk of squares as large as `one`, in the middle of each of 3 x 3 parts of the field; `make`: what is written of
// one.
engine::Result<double> meanElsewhere(const PlannedWork& work, const engine::SampleRect& one,
                                     const PlannedOnPieces::Work& make, const ScratchFolder& folder,
                                     engine::JobControl& job) {
  constexpr int kSide = 3;
  const engine::Grid& grid = work.field.grid();
  engine::JobControl own = engine::JobControl::partOf(job);
  double bytes = 0.0;
  for (int i = 0; i < kSide * kSide; ++i) {
    const auto middle = [](int part, std::int32_t side) {
      return static_cast<std::int32_t>((2 * part + 1) * std::int64_t{side} / (2 * kSide));
    };
    const engine::SampleRect at =
        squareAt(grid, middle(i % kSide, grid.width) - one.columns / 2,
                 middle(i / kSide, grid.height) - one.rows / 2, std::max(one.columns, one.rows));
    const auto made = make(at, own);
    if (job.cancelled()) return engine::cancelled();
    if (!made) return tl::unexpected(made.error());
    const auto cost = costOf(work, *made, at, std::nullopt, folder, job);
    if (job.cancelled()) return engine::cancelled();
    if (!cost) return tl::unexpected(cost.error());
    bytes += cost->bytes;
  }
  return bytes / (kSide * kSide);
}

// What makes the squares of which the mean counts; empty: those that were worked out are enough.
PlannedOnPieces::Work unevenWork(const PlannedWork& work) {
  if (work.steps.empty())
    return [&work](const engine::SampleRect& at, engine::JobControl&) {
      return engine::Result<engine::Version>(pieceAt(work.field, at));
    };
  const auto* const last = std::get_if<PlannedOnPieces>(&work.steps.back());
  return last != nullptr && last->uneven ? last->work : PlannedOnPieces::Work();
}

// The disk of a mesh with an error [bytes]: whole blocks of its triangles, which no cut adds any to, in 3 x 3 parts of the
// field, or 4 x 4 where an estimate alone is asked for. Nothing where the field has too few of them.
engine::Result<std::optional<double>> meshBytes(const PlannedWork& work, bool always,
                                                const ScratchFolder& folder, engine::JobControl& job) {
  constexpr std::int32_t kCells = engine::SurfaceMesh::kBlock;
  const engine::Grid& grid = work.field.grid();
  const std::int32_t across = (grid.width - 1) / kCells, down = (grid.height - 1) / kCells;
  const std::int32_t parts = always ? 4 : 3;
  if (!work.writing.max_error || across < parts || down < parts) return std::optional<double>();
  double bytes = 0.0;
  for (std::int32_t i = 0; i < parts * parts; ++i) {
    const auto block = [&](std::int32_t part, std::int32_t blocks) {
      return static_cast<std::int32_t>((2 * part + 1) * std::int64_t{blocks} / (2 * parts)) * kCells;
    };
    const engine::SampleRect at{block(i % parts, across), block(i / parts, down), kCells + 1, kCells + 1};
    const auto cost = costOf(work, pieceAt(work.field, at), at, std::nullopt, folder, job);
    if (job.cancelled()) return engine::cancelled();
    // A block of holes has no surface.
    if (!cost && cost.error().kind == engine::ErrorKind::kInput) continue;
    if (!cost) return tl::unexpected(cost.error());
    bytes += cost->bytes;
  }
  return bytes / (parts * parts) * (grid.width - 1) * (grid.height - 1) / (double{kCells} * kCells);
}

engine::Result<WritingCost> writing(const PlannedWork& work, const Pieces& pieces, bool always,
                                    engine::JobControl& job) {
  if (work.out.empty()) return WritingCost{};
  const auto folder =
      ScratchFolder::create(isStream(work.out) ? std::string() : folderFor(work.out).string());
  if (!folder) return tl::unexpected(folder.error());
  std::array<double, 3> bytes = {}, seconds = {}, memory = {};
  if (work.alike) return costOf(work, pieces.made[0], pieces.at[0], pieces.originals[0], *folder, job);
  for (int i = 0; i < 3; ++i) {
    const auto cost = costOf(work, pieces.made[i], pieces.at[i], pieces.originals[i], *folder, job);
    if (!cost) return tl::unexpected(cost.error());
    bytes[i] = cost->bytes;
    seconds[i] = cost->seconds;
    memory[i] = cost->memory;
  }
  const std::array<double, 3> samples = pieces.madeSamples();
  const double all = work.result * static_cast<double>(work.field.grid().samples());
  // The third piece of a filter's sample is more than what was filtered. A session has whole tiles, so that of other work
  // the largest piece shows best what a sample takes; of squares all over the field that piece is one.
  const auto make = unevenWork(work);
  const bool filtered = !work.steps.empty() && std::holds_alternative<PlannedFilter>(work.steps.back());
  const int size = filtered || (make && !always) ? 1 : 2;
  WritingCost whole{ofAll(all, 0, size, samples, bytes), ofAll(all, 0, 2, samples, seconds),
                    memoryOfAll(all, samples, memory)};
  const auto mesh = meshBytes(work, always, *folder, job);
  if (!mesh) return tl::unexpected(mesh.error());
  if (*mesh) {
    whole.bytes = **mesh;
  } else if (make) {
    const auto elsewhere = meanElsewhere(work, pieces.at[size], make, *folder, job);
    if (!elsewhere) return tl::unexpected(elsewhere.error());
    whole.bytes = std::max(0.0, whole.bytes + (*elsewhere - bytes[size]) / samples[size] * all);
  }
  return whole;
}

// Squares of a filtered sample. As large as what was filtered, as filtered heights take less where they are compressed;
// the third one, for the time, is larger.
Pieces piecesOf(const engine::WorkSample& sample) {
  const engine::Grid& grid = sample.worked.grid();
  const std::int32_t tiles =
      std::min(sample.block.column1 - sample.block.column0, sample.block.row1 - sample.block.row0);
  const std::int32_t most = std::clamp(tiles * engine::kTileSide, 64, 512);
  const std::int32_t sides[] = {most / 2, most, 1024};
  Pieces pieces;
  for (int i = 0; i < 3; ++i) {
    pieces.at[i] = squareAt(grid, sample.block.column0 * engine::kTileSide,
                            sample.block.row0 * engine::kTileSide, sides[i]);
    pieces.made[i] = pieceAt(sample.worked, pieces.at[i]);
  }
  return pieces;
}

// No sample is taken where it would be more than this share of the work.
constexpr double kMostShare = 1.0 / 32.0;

// Pieces from the middle of the field, each worked out. Nothing where that would be too much of the work.
engine::Result<std::optional<Pieces>> workPieces(const PlannedWork& work, const PlannedOnPieces& step,
                                                 bool always, engine::JobControl& job) {
  const engine::Grid& grid = work.field.grid();
  const double all = std::min(step.most_samples, step.share * static_cast<double>(grid.samples()));
  // Of work that is long for few samples the largest piece is what the share allows.
  const double affordable = std::sqrt(kMostShare * all / 1.3125);
  if (!always && affordable < 64.0) return std::nullopt;
  if (!always && step.whole && step.share * static_cast<double>(grid.samples()) < step.whole->fewest_samples)
    return std::nullopt;
  const std::int32_t largest = std::clamp(static_cast<std::int32_t>(affordable), always ? 192 : 64, 1024);
  Pieces pieces;
  engine::JobControl own = engine::JobControl::partOf(job);  // whose stages are not shown
  for (int i = 0; i < 3; ++i) {
    const std::int32_t side = largest >> (2 - i);
    pieces.at[i] = step.amount ? squareAt(grid, step.column - side / 2, step.row - side / 2, side)
                               : squareAt(grid, (grid.width - side) / 2, (grid.height - side) / 2, side);
  }
  pieces.amounts = pieces.samples();
  pieces.all = all;
  if (step.amount) {
    for (int i = 0; i < 3; ++i) pieces.amounts[i] = step.amount(pieces.at[i]);
    pieces.all = step.amount({0, 0, grid.width, grid.height});
    if (pieces.amounts[2] <= 0.0 || (!always && pieces.amounts[2] > kMostShare * pieces.all))
      return std::nullopt;
  }
  for (int i = 0; i < 3; ++i) {
    engine::releaseFreeMemory();
    const std::uint64_t before = engine::residentMemory().now +
                                 static_cast<std::uint64_t>(step.fields) *
                                     engine::fieldBytes(static_cast<std::uint64_t>(pieces.at[i].columns),
                                                        static_cast<std::uint64_t>(pieces.at[i].rows));
    const bool peak_known = engine::resetPeak();
    const engine::Stopwatch watch;
    auto made = step.work(pieces.at[i], own);
    pieces.seconds[i] = watch.seconds();
    if (job.cancelled()) return engine::cancelled();
    if (!made) return tl::unexpected(made.error());
    pieces.made[i] = *std::move(made);
    if (step.of_original) {
      auto original = step.of_original(pieces.at[i], own);
      if (job.cancelled()) return engine::cancelled();
      if (!original) return tl::unexpected(original.error());
      pieces.originals[i] = *std::move(original);
    }
    if (const std::uint64_t peak = engine::residentMemory().peak; peak_known && peak > before)
      pieces.memory[i] = static_cast<double>(peak - before);
  }
  return pieces;
}

// A filter none of whose blocks is worked out alone, as one on pieces: its time is about in proportion to the samples, also
// where it goes over them round by round, as rounds depend on how the heights scatter more than on how many there are.
std::optional<PlannedOnPieces> asPieces(const PlannedWork& work, const PlannedStep& step) {
  const auto* const filter = std::get_if<PlannedFilter>(&step);
  if (filter == nullptr || engine::filterOf(filter->spec.kind).sampled) return std::nullopt;
  PlannedOnPieces pieces;
  pieces.work = [&work, filter](const engine::SampleRect& rect,
                                engine::JobControl& job) -> engine::Result<engine::Version> {
    const engine::Version input = pieceAt(work.field, rect);
    auto filtered = filter->compute.apply(input, pieceAt(work.original, rect), filter->spec, job);
    if (!filtered) return tl::unexpected(std::move(filtered.error()));
    return std::move(filtered->field);
  };
  pieces.fields = 2;
  pieces.share = filter->share;
  return pieces;
}

std::string bytesText(std::uint64_t bytes) {
  const auto value = static_cast<double>(bytes);
  if (value < 1e6) return fmt::format("{:.0f} kB", value * 1e-3);
  return value < 1e9 ? fmt::format("{:.0f} MB", value * 1e-6) : fmt::format("{:.1f} GB", value * 1e-9);
}

// What work may take that its sample did not show [bytes]: measured up to 56 MB of a suggestion.
double unseenMemory() {
  return 64e6 * std::max(1U, std::thread::hardware_concurrency());
}

// Whether so much of a disk certainly is not there.
bool tooMuch(std::uint64_t needed, std::uint64_t free) {
  return 0.9 * static_cast<double>(needed) > static_cast<double>(free);
}

}  // namespace

engine::Result<std::optional<WorkEstimate>> estimateWork(const PlannedWork& work, bool always,
                                                         engine::JobControl& job, double most_seconds) {
  const std::uint64_t reading = engine::residentMemory().peak;  // resetPeak() forgets it
  const engine::Grid& grid = work.field.grid();
  const auto samples = static_cast<double>(grid.samples());
  const auto field_bytes = static_cast<double>(
      engine::fieldBytes(static_cast<std::uint64_t>(grid.width), static_cast<std::uint64_t>(grid.height)));
  WorkEstimate estimate;
  Pieces result;
  bool long_enough = false;
  double tiles_taken = 0.0, beside = 0.0, kept = 0.0;
  int states = 0;
  for (const PlannedStep& planned : work.steps) {
    const std::optional<PlannedOnPieces> in_pieces = asPieces(work, planned);
    const PlannedStep step = in_pieces ? PlannedStep(*in_pieces) : planned;
    if (const auto* on_pieces = std::get_if<PlannedOnPieces>(&step)) {
      const auto pieces = workPieces(work, *on_pieces, always, job);
      if (!pieces) return tl::unexpected(pieces.error());
      if (!*pieces) continue;
      long_enough = true;
      result = **pieces;
      double seconds = ofAll(result.all, 1, 2, result.amounts, result.seconds);
      if (on_pieces->whole) {
        engine::JobControl own = engine::JobControl::partOf(job);  // whose stages are not shown
        const auto whole = on_pieces->whole->seconds(own);
        if (job.cancelled()) return engine::cancelled();
        if (!whole) return tl::unexpected(whole.error());
        seconds = *whole;
      }
      estimate.work_seconds += seconds;
      const double all = std::min(on_pieces->most_samples, on_pieces->share * samples);
      beside =
          std::max(beside, on_pieces->memory_each > 0.0 ? all * on_pieces->memory_each
                                                        : memoryOfAll(all, result.samples(), result.memory));
      continue;
    }
    const auto& filter = std::get<PlannedFilter>(step);
    engine::SampleOptions options;
    options.seconds = most_seconds;
    if (always) options.most_share = 1.0;
    options.on_device = !filter.compute.device().empty();
    const auto apply = [&](const engine::FilterSpec& spec, engine::FilterWork& blocks,
                           engine::JobControl& own) {
      return filter.compute.apply(work.field, work.original, spec, own, &blocks);
    };
    auto sample = engine::sampleWork(filter.spec, apply, options, job);
    if (job.cancelled()) return engine::cancelled();
    // The filter itself may run on the processor after a device that fails.
    if (!sample && options.on_device && !always) return std::nullopt;
    if (!sample) return tl::unexpected(sample.error());
    // The state before a pass and that after it, where the former is not the input.
    states += filter.spec.passes;
    if (!*sample) {
      tiles_taken = std::max(tiles_taken, filter.share * field_bytes);
      continue;
    }
    long_enough = true;
    estimate.work_seconds += filter.share * (*sample)->seconds;
    tiles_taken = std::max(tiles_taken, filter.share * (*sample)->changed_share * field_bytes);
    // Twice and a half: pieces of the heap that were freed do not all fit what is asked for next (tgv, whose squares differ in size), by
    // an eighth of all memory more or less from run to run, as threads take turns.
    beside = std::max(beside, 2.5 * static_cast<double>((*sample)->scratch_bytes));
    kept += filter.share * (*sample)->changed_share * 4.0 * samples * (filter.spec.passes > 1 ? 2.0 : 1.0);
    result = piecesOf(**sample);
  }
  if (work.steps.empty()) {
    // The writing alone is the work.
    PlannedOnPieces as_it_is{[&](const engine::SampleRect& rect, engine::JobControl&) {
      return engine::Result<engine::Version>(pieceAt(work.field, rect));
    }};
    const auto pieces = workPieces(work, as_it_is, always, job);
    if (!pieces) return tl::unexpected(pieces.error());
    long_enough = pieces->has_value();
    if (long_enough) result = **pieces;
  }
  if (!long_enough) return std::nullopt;
  const auto cost = writing(work, result, always, job);
  if (!cost) return tl::unexpected(cost.error());
  estimate.write_seconds = cost->seconds;
  estimate.disk_bytes = static_cast<std::uint64_t>(cost->bytes);
  // What the sample itself left behind, as libraries that it loaded, is there when the work begins; so are free tiles.
  result = {};
  engine::releaseFreeMemory();
  const engine::ResidentMemory before = engine::residentMemory();
  const double there = static_cast<double>(work.field.memory()->bulk().freeObjects()) * sizeof(engine::Tile);
  const auto tiles = static_cast<std::uint64_t>(std::max(0.0, tiles_taken * std::min(states, 2) - there));
  const bool stored = work.field.memory()->store != nullptr;
  estimate.memory_bytes = (stored ? before.own : before.now) + (stored ? 0 : tiles) +
                          static_cast<std::uint64_t>(std::max(beside, cost->memory));
  if (!stored) estimate.memory_bytes = std::max(estimate.memory_bytes, reading);
  if (stored) estimate.store_bytes = tiles;
  if (work.kept) estimate.kept_bytes = static_cast<std::uint64_t>(kept);
  return estimate;
}

engine::Status checkRoom(const WorkEstimate& estimate, const PlannedWork& work) {
  std::error_code error;
  if (!work.out.empty() && !isStream(work.out)) {
    const std::uint64_t needed = estimate.disk_bytes + estimate.kept_bytes;
    const auto disk = std::filesystem::space(folderFor(work.out), error);
    if (!error && tooMuch(needed, disk.available))
      return engine::failure(fmt::format("the result needs about {} of disk, {} are free", bytesText(needed),
                                         bytesText(disk.available)),
                             work.out, "free space, or name an output on another disk");
  }
  if (estimate.store_bytes > 0) {
    const std::string& folder = work.field.memory()->store->folder();
    const auto disk = std::filesystem::space(folder, error);
    if (!error && tooMuch(estimate.store_bytes, disk.available))
      return engine::failure(fmt::format("the work needs about {} of the store's disk, {} are free",
                                         bytesText(estimate.store_bytes), bytesText(disk.available)),
                             folder, "free space, or name a folder on another disk with --store");
  }
  const std::uint64_t have = engine::residentMemory().now, free = engine::availableMemory();
  if (free > 0 && estimate.memory_bytes > have &&
      1.1 * static_cast<double>(estimate.memory_bytes - have) + unseenMemory() > static_cast<double>(free))
    return engine::failure(fmt::format("the work needs about {} of memory more, {} are free",
                                       bytesText(estimate.memory_bytes - have), bytesText(free)),
                           work.out,
                           "close other programs, or keep the samples on a disk with --store FOLDER");
  return {};
}

std::string textOf(const WorkEstimate& estimate) {
  const std::uint64_t disk = estimate.disk_bytes + estimate.kept_bytes;
  std::string text = fmt::format("about {}, {} of memory{}", durationText(estimate.seconds()),
                                 bytesText(estimate.memory_bytes),
                                 disk > 0 ? fmt::format(" and {} of disk", bytesText(disk)) : "");
  if (estimate.store_bytes > 0) text += fmt::format(", {} of the store's", bytesText(estimate.store_bytes));
  return text;
}

Report reportOf(const WorkEstimate& estimate) {
  return {{"seconds", estimate.seconds()},           {"work_seconds", estimate.work_seconds},
          {"write_seconds", estimate.write_seconds}, {"memory_bytes", estimate.memory_bytes},
          {"disk_bytes", estimate.disk_bytes},       {"kept_bytes", estimate.kept_bytes},
          {"store_bytes", estimate.store_bytes}};
}

}  // namespace fettle::app
