#include "app/work/work_estimate.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "app/terminal.h"
#include "app/work/streams.h"
#include "engine/base/memory.h"
#include "engine/base/stopwatch.h"
#include "engine/field/piece.h"
#include "engine/field/tile.h"
#include "engine/field/tile_store.h"
#include "engine/filter/work_sample.h"
#include "engine/formats/formats.h"

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

// A square of at most `side` samples from a place of the field on.
engine::Version square(const engine::Version& field, std::int32_t column, std::int32_t row,
                       std::int32_t side) {
  const engine::Grid& grid = field.grid();
  const std::int32_t columns = std::min(side, grid.width), rows = std::min(side, grid.height);
  return engine::pieceOf(field, std::min(column, grid.width - columns), std::min(row, grid.height - rows),
                         columns, rows);
}

engine::Result<WritingCost> costOf(const PlannedWork& work, const engine::Version& filtered,
                                   std::int32_t column, std::int32_t row, std::int32_t side,
                                   const ScratchFolder& folder, engine::JobControl& job) {
  const engine::Version piece = square(filtered, column, row, side);
  engine::ExportOptions writing = work.writing;
  if (writing.original) writing.original = square(work.original, column, row, side);
  const std::string path = fmt::format("{}/{}{}", folder.path(), side, work.extension);
  const std::uint64_t before = engine::residentMemory().now;
  const bool peak_known = engine::resetPeak();
  const engine::Stopwatch watch;
  const auto written = engine::exportField(piece, path, writing, job);
  if (!written) return tl::unexpected(written.error());
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

// Of the whole field, from two squares: what both have in common is there once.
engine::Result<WritingCost> writing(const PlannedWork& work, const engine::WorkSample& sample,
                                    engine::JobControl& job) {
  const auto folder =
      ScratchFolder::create(isStream(work.out) ? std::string() : folderFor(work.out).string());
  if (!folder) return tl::unexpected(folder.error());
  const engine::Grid& grid = work.field.grid();
  const std::int32_t column = sample.block.column0 * engine::kTileSide,
                     row = sample.block.row0 * engine::kTileSide;
  const std::int32_t tiles =
      std::min(sample.block.column1 - sample.block.column0, sample.block.row1 - sample.block.row0);
  // As large as what was filtered, as filtered heights take less where they are compressed.
  const std::int32_t most = std::clamp(tiles * engine::kTileSide, 64, 512);
  const std::int32_t sides[] = {most / 2, most, 1024};
  WritingCost costs[3];
  double samples[3];
  for (int i = 0; i < 3; ++i) {
    const auto cost = costOf(work, sample.worked, column, row, sides[i], *folder, job);
    if (!cost) return tl::unexpected(cost.error());
    costs[i] = *cost;
    samples[i] = static_cast<double>(std::min(sides[i], grid.width)) * std::min(sides[i], grid.height);
  }
  const auto all = static_cast<double>(grid.samples());
  const auto from = [&](int few, int many, double WritingCost::*member) {
    if (samples[many] <= samples[few]) return costs[many].*member / samples[many] * all;
    const double each =
        std::max(0.0, (costs[many].*member - costs[few].*member) / (samples[many] - samples[few]));
    return costs[many].*member + each * (all - samples[many]);
  };
  return WritingCost{from(0, 1, &WritingCost::bytes), from(0, 2, &WritingCost::seconds), costs[2].memory};
}

std::string bytesText(std::uint64_t bytes) {
  const auto value = static_cast<double>(bytes);
  if (value < 1e6) return fmt::format("{:.0f} kB", value * 1e-3);
  return value < 1e9 ? fmt::format("{:.0f} MB", value * 1e-6) : fmt::format("{:.1f} GB", value * 1e-9);
}

// Whether so much certainly does not fit.
bool tooMuch(std::uint64_t needed, std::uint64_t free) {
  return 0.9 * static_cast<double>(needed) > static_cast<double>(free);
}

}  // namespace

engine::Result<std::optional<WorkEstimate>> estimateWork(const PlannedWork& work, bool always,
                                                         engine::JobControl& job, double most_seconds) {
  engine::SampleOptions options;
  options.seconds = most_seconds;
  if (always) options.most_share = 1.0;
  options.on_device = !work.compute.device().empty();
  const engine::ResidentMemory before = engine::residentMemory();
  const std::size_t free_tiles = work.field.memory()->bulk().freeObjects();
  const auto apply = [&](const engine::FilterSpec& spec, engine::FilterWork& blocks,
                         engine::JobControl& own) {
    return work.compute.apply(work.field, work.original, spec, own, &blocks);
  };
  auto sample = engine::sampleWork(work.spec, apply, options, job);
  if (job.cancelled()) return engine::cancelled();
  // The filter itself may run on the processor after a device that fails.
  if (!sample && options.on_device && !always) return std::nullopt;
  if (!sample) return tl::unexpected(sample.error());
  if (!*sample) return std::nullopt;
  const auto cost = writing(work, **sample, job);
  if (!cost) return tl::unexpected(cost.error());

  const engine::Grid& grid = work.field.grid();
  WorkEstimate estimate;
  estimate.filter_seconds = (*sample)->seconds;
  estimate.write_seconds = cost->seconds;
  estimate.disk_bytes = static_cast<std::uint64_t>(cost->bytes);
  const double changed = (*sample)->changed_share *
                         static_cast<double>(engine::fieldBytes(static_cast<std::uint64_t>(grid.width),
                                                                static_cast<std::uint64_t>(grid.height)));
  // The state before a pass and that after it, where the former is not the input.
  const double taken = changed * (work.spec.passes > 1 ? 2.0 : 1.0);
  // Tiles of earlier work that are free are in the memory already.
  const double there = static_cast<double>(free_tiles) * sizeof(engine::Tile);
  const auto tiles = static_cast<std::uint64_t>(std::max(0.0, taken - there));
  const bool stored = work.field.memory()->store != nullptr;
  estimate.memory_bytes = (stored ? before.own : before.now) + (stored ? 0 : tiles) +
                          std::max((*sample)->scratch_bytes, static_cast<std::uint64_t>(cost->memory));
  if (stored) estimate.store_bytes = tiles;
  if (work.kept) {
    const double samples = (*sample)->changed_share * 4.0 * static_cast<double>(grid.samples());
    estimate.kept_bytes = static_cast<std::uint64_t>(samples * (work.spec.passes > 1 ? 2.0 : 1.0));
  }
  return estimate;
}

engine::Status checkRoom(const WorkEstimate& estimate, const PlannedWork& work) {
  std::error_code error;
  if (!isStream(work.out)) {
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
      return engine::failure(fmt::format("the filter needs about {} of the store's disk, {} are free",
                                         bytesText(estimate.store_bytes), bytesText(disk.available)),
                             folder, "free space, or name a folder on another disk with --store");
  }
  const std::uint64_t have = engine::residentMemory().now, free = engine::availableMemory();
  if (free > 0 && estimate.memory_bytes > have && tooMuch(estimate.memory_bytes - have, free))
    return engine::failure(fmt::format("the filter needs about {} of memory more, {} are free",
                                       bytesText(estimate.memory_bytes - have), bytesText(free)),
                           work.out,
                           "close other programs, or keep the samples on a disk with --store FOLDER");
  return {};
}

std::string textOf(const WorkEstimate& estimate) {
  std::string text =
      fmt::format("about {}, {} of memory and {} of disk", durationText(estimate.seconds()),
                  bytesText(estimate.memory_bytes), bytesText(estimate.disk_bytes + estimate.kept_bytes));
  if (estimate.store_bytes > 0) text += fmt::format(", {} of the store's", bytesText(estimate.store_bytes));
  return text;
}

Report reportOf(const WorkEstimate& estimate) {
  return {{"seconds", estimate.seconds()},           {"filter_seconds", estimate.filter_seconds},
          {"write_seconds", estimate.write_seconds}, {"memory_bytes", estimate.memory_bytes},
          {"disk_bytes", estimate.disk_bytes},       {"kept_bytes", estimate.kept_bytes},
          {"store_bytes", estimate.store_bytes}};
}

}  // namespace fettle::app
