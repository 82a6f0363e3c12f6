#include "app/commands/shards/gathering.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/commands/output_checks.h"
#include "app/commands/scan_files.h"
#include "app/commands/shards/plan.h"
#include "app/commands/shards/vrt_text.h"
#include "app/commands/shell_word.h"
#include "app/terminal.h"
#include "engine/field/builder.h"
#include "engine/field/content_hash.h"
#include "engine/field/tile.h"
#include "engine/formats/formats.h"
#include "engine/io/files/atomic_file.h"
#include "engine/io/files/input_file.h"
#include "engine/shard/bands.h"

namespace fettle::app {

namespace {

using engine::RowSpan;

engine::Grid sidesOf(const ShardPlan& plan) {
  engine::Grid grid;
  grid.width = plan.width;
  grid.height = plan.height;
  return grid;
}

// What the rows of one shard are read from.
class ShardRows {
 public:
  static engine::Result<ShardRows> open(const ShardFolder& folder, const ShardPlan& plan, int number,
                                        const RowSpan& own) {
    if (plan.one_file) {
      auto rows = engine::PlainRows::open(folder.whole(), *plan.one_file);
      if (!rows) return tl::unexpected(rows.error());
      return ShardRows(*std::move(rows), 0);
    }
    const auto layout = engine::layoutOfPlainTiff(folder.rows(number), plan.width, own.count);
    if (!layout) return tl::unexpected(layout.error());
    auto rows = engine::PlainRows::open(folder.rows(number), *layout);
    if (!rows) return tl::unexpected(rows.error());
    return ShardRows(*std::move(rows), own.first);
  }
  [[nodiscard]] engine::Status read(std::int32_t row, std::int32_t rows, float* heights) const {
    return rows_.read(row - first_, rows, heights);
  }

 private:
  ShardRows(engine::PlainRows rows, std::int32_t first) : rows_(std::move(rows)), first_(first) {}
  engine::PlainRows rows_;
  std::int32_t first_;
};

// Takes rows of the result, from row 0 on.
using TakeRows = std::function<engine::Status(std::int32_t row, std::int32_t rows, const float* heights)>;

struct Total {
  std::int64_t samples = 0, holes = 0, changed = 0;
  double max_change = 0.0, squares = 0.0, seconds = 0.0;

  void add(const Report& shard) {
    samples += shard["samples"].get<std::int64_t>();
    holes += shard["no_data"].get<std::int64_t>();
    changed += shard["changed"].get<std::int64_t>();
    max_change = std::max(max_change, shard["max_change"].get<double>());
    squares += shard["squares"].get<double>();
    seconds += shard["seconds"].get<double>();
  }
};

std::string remedyFor(const ShardPlan& plan, const std::vector<int>& numbers) {
  if (plan.inTurn()) return fmt::format("the same command continues: {}", fettleCommand(plan.arguments));
  const std::string command = fettleCommand(shardWords(plan.command, plan.arguments, plan.threads));
  return fmt::format("run {}: {} --shard {}/{}", numbers.size() == 1 ? "it" : "them", command,
                     numbers.size() == 1 ? std::to_string(numbers.front()) : std::string("K"), plan.shards);
}

// Reads every row in order and holds it against its shard's hash; the hash of all together.
engine::Result<std::uint64_t> readAll(const ShardFolder& folder, const ShardPlan& plan,
                                      const std::vector<Report>& shards, const TakeRows& take,
                                      engine::JobControl& job) {
  engine::ContentHash all(plan.width, plan.height);
  const auto row_samples = static_cast<std::size_t>(plan.width);
  std::vector<float> heights(row_samples * static_cast<std::size_t>(engine::kTileSide));
  std::vector<int> damaged;
  job.begin("gathering", static_cast<std::uint64_t>(plan.height));
  for (int k = 1; k <= plan.shards; ++k) {
    const RowSpan own = engine::bandOf(sidesOf(plan), {k, plan.shards});
    if (own.count == 0) continue;
    const auto rows = ShardRows::open(folder, plan, k, own);
    if (!rows) {
      // Rows that the system does not give now are no damage.
      if (rows.error().kind == engine::ErrorKind::kFailed) return tl::unexpected(rows.error());
      damaged.push_back(k);
      continue;
    }
    engine::ContentHash hash(plan.width, own.count);
    engine::Status readable;
    for (std::int32_t row = own.first; row < own.end() && readable; row += engine::kTileSide) {
      if (job.cancelled()) return engine::cancelled();
      const std::int32_t now = std::min(engine::kTileSide, own.end() - row);
      readable = rows->read(row, now, heights.data());
      if (!readable && readable.error().kind == engine::ErrorKind::kFailed)
        return tl::unexpected(readable.error());
      if (!readable) break;
      for (std::int32_t r = 0; r < now; ++r) {
        const float* const of_row = heights.data() + static_cast<std::size_t>(r) * row_samples;
        hash.addRow(of_row, nullptr);
        all.addRow(of_row, nullptr);
      }
      if (damaged.empty() && take)
        if (auto taken = take(row, now, heights.data()); !taken) return tl::unexpected(taken.error());
      job.advance(static_cast<std::uint64_t>(now));
    }
    const std::string stated = shards[static_cast<std::size_t>(k - 1)]["hash"].get<std::string>();
    if (!readable || fmt::format("{:016x}", hash.value()) != stated) damaged.push_back(k);
  }
  if (damaged.empty()) return all.value();
  // They are to be done again, by the same command.
  std::error_code ignored;
  for (const int k : damaged) std::filesystem::remove(folder.done(k), ignored);
  return engine::failure(fmt::format("the rows of shard {} of {} are not what {} wrote", numbersText(damaged),
                                     plan.shards, damaged.size() == 1 ? "it" : "they"),
                         folder.path(), remedyFor(plan, damaged));
}

// The grid of the result: that of the first shard's file that can be read, at the place of the whole. One that cannot is found
// damaged when its rows are read.
engine::Result<engine::Grid> gridOf(const ShardFolder& folder, const ShardPlan& plan) {
  engine::Error error;
  for (int k = 1; k <= plan.shards; ++k) {
    const RowSpan own = engine::bandOf(sidesOf(plan), {k, plan.shards});
    if (own.count == 0) continue;
    const auto grid = engine::importGrid(folder.rows(k), {});
    if (!grid) error = grid.error();
    if (!grid || !*grid) continue;
    engine::Grid whole = **grid;
    whole.height = plan.height;
    whole.origin_y -= own.first * whole.spacing_y;
    return whole;
  }
  if (!error.what.empty()) return tl::unexpected(error);
  return engine::failure("no shard has a file with rows", folder.path(), "do the shards again");
}

// `out` of the shards' files: by its path from here, the plan's is that from where it was made. Returns the hash.
engine::Result<std::uint64_t> assemble(const std::string& out, const ShardFolder& folder,
                                       const ShardPlan& plan, const std::vector<Report>& shards,
                                       engine::JobControl& job) {
  const auto grid = gridOf(folder, plan);
  if (!grid) return tl::unexpected(grid.error());
  if (writesPlainTiff(plan.out, plan.settings)) {
    const auto layout = engine::createPlainTiff(*grid, folder.whole());
    if (!layout) return tl::unexpected(layout.error());
    auto rows = engine::PlainRows::open(folder.whole(), *layout);
    if (!rows) return tl::unexpected(rows.error());
    auto hash = readAll(
        folder, plan, shards,
        [&](std::int32_t row, std::int32_t count, const float* heights) {
          return rows->write(row, count, heights);
        },
        job);
    engine::Status done = hash ? rows->flush() : engine::Status(tl::unexpected(hash.error()));
    if (done) done = engine::replaceFile(folder.whole(), out);
    std::error_code ignored;
    if (!done) {
      std::filesystem::remove(folder.whole(), ignored);
      return tl::unexpected(done.error());
    }
    return hash;
  }
  auto builder = engine::FieldBuilder::create(*grid, out);
  if (!builder) return tl::unexpected(builder.error());
  auto hash = readAll(
      folder, plan, shards,
      [&](std::int32_t row, std::int32_t count, const float* heights) -> engine::Status {
        builder->writeHeights(0, row, plan.width, count, heights, plan.width);
        return {};
      },
      job);
  if (!hash) return hash;
  engine::ExportOptions writing;
  if (plan.settings.contains("compress"))
    writing.tiff_compression = static_cast<engine::TiffCompression>(plan.settings["compress"].get<int>());
  writing.cloud_optimised = plan.settings.contains("cloud-optimised");
  writing.ascii = plan.settings.contains("ascii");
  if (auto status = saveField(std::move(*builder).build(), out, job, writing); !status)
    return tl::unexpected(status.error());
  return hash;
}

engine::Status writeVrt(const std::string& path, const ShardFolder& folder, const ShardPlan& plan) {
  const auto grid = gridOf(folder, plan);
  if (!grid) return tl::unexpected(grid.error());
  std::vector<VrtPart> parts;
  for (int k = 1; k <= plan.shards; ++k)
    if (const RowSpan own = engine::bandOf(sidesOf(plan), {k, plan.shards}); own.count > 0)
      parts.push_back({std::filesystem::absolute(folder.rows(k)).string(), own.first, own.count});
  return engine::writeFileAtomically(path, vrtText(*grid, parts));
}

}  // namespace

std::string numbersText(const std::vector<int>& numbers) {
  std::vector<std::string> runs;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t j = i;
    while (j + 1 < numbers.size() && numbers[j + 1] == numbers[j] + 1) ++j;
    if (j > i + 1) {
      runs.push_back(fmt::format("{} to {}", numbers[i], numbers[j]));
      i = j + 1;
    } else {
      runs.push_back(std::to_string(numbers[i++]));
    }
  }
  if (runs.empty()) return "";
  std::string text = runs.front();
  for (std::size_t i = 1; i < runs.size(); ++i) text += (i + 1 == runs.size() ? " and " : ", ") + runs[i];
  return text;
}

Report reportOfShard(const ShardFolder& folder, const ShardPlan& plan, int number) {
  std::ifstream file(folder.done(number), std::ios::binary);
  if (!file.is_open()) return {};
  Report report = Report::parse(file, nullptr, false);
  const auto has = [&](const char* key, bool (Report::*is)() const noexcept) {
    return report.contains(key) && (report[key].*is)();
  };
  if (!report.is_object() || report.value("plan", Report()) != plan.id() ||
      report.value("shard", Report()) != number || !has("hash", &Report::is_string))
    return {};
  for (const char* key : {"samples", "no_data", "changed", "max_change", "squares", "seconds"})
    if (!has(key, &Report::is_number)) return {};
  report.erase("schema");
  std::error_code error;
  const bool has_rows = engine::bandOf(sidesOf(plan), {number, plan.shards}).count > 0;
  if (has_rows && !std::filesystem::exists(plan.one_file ? folder.whole() : folder.rows(number), error))
    return {};
  return report;
}

engine::Result<Report> gatherBands(const std::string& out, const GatherOptions& options,
                                   engine::JobControl& job) {
  const ShardFolder folder(out);
  const auto plan = readPlan(folder.plan());
  if (!plan) return tl::unexpected(plan.error());
  if (!options.vrt.empty() && plan->one_file)
    return engine::inputError("the shards wrote into one file, there is nothing for a VRT to name",
                              options.vrt, "leave --vrt out, or plan with --result files");
  if (auto status =
          checkOutputs(options.vrt.empty() ? std::vector<Output>{{out, OutputKind::kField, {}}}
                                           : std::vector<Output>{{options.vrt, OutputKind::kText, {}}},
                       {plan->in}, Replacing::kNoWork, job);
      !status)
    return tl::unexpected(status.error());
  std::vector<Report> shards;
  std::vector<int> missing;
  Total total;
  for (int k = 1; k <= plan->shards; ++k) {
    shards.push_back(reportOfShard(folder, *plan, k));
    if (shards.back().is_null())
      missing.push_back(k);
    else
      total.add(shards.back());
  }
  if (!missing.empty())
    return engine::failure(fmt::format("{} of {} shards {} not done: {}", missing.size(), plan->shards,
                                       missing.size() == 1 ? "is" : "are", numbersText(missing)),
                           folder.path(), remedyFor(*plan, missing));
  engine::Result<std::uint64_t> hash;
  if (!options.vrt.empty()) {
    hash = readAll(folder, *plan, shards, {}, job);
    if (hash)
      if (auto status = writeVrt(options.vrt, folder, *plan); !status) return tl::unexpected(status.error());
  } else if (plan->one_file) {
    hash = readAll(folder, *plan, shards, {}, job);
    if (hash)
      if (auto status = engine::replaceFile(folder.whole(), out); !status)
        return tl::unexpected(status.error());
  } else {
    hash = assemble(out, folder, *plan, shards, job);
  }
  if (!hash) return tl::unexpected(hash.error());
  if (options.vrt.empty() && !options.keep) {
    std::error_code ignored;
    std::filesystem::remove_all(folder.path(), ignored);
  }
  Report report{{"shards", plan->shards}, {"plan", plan->id()}};
  if (plan->settings.contains("filter")) report["filter"] = plan->settings["filter"];
  report["range_sigma"] = plan->range_sigma ? Report(*plan->range_sigma) : Report();
  report.update({{"unit", plan->unit},
                 {"changed", total.changed},
                 {"max_change", total.max_change},
                 {"rms_change",
                  total.samples > 0 ? std::sqrt(total.squares / static_cast<double>(total.samples)) : 0.0},
                 {"no_data", total.holes},
                 {"shard_seconds", total.seconds},
                 {"out", options.vrt.empty() ? out : options.vrt},
                 {"hash", fmt::format("{:016x}", *hash)}});
  return report;
}

}  // namespace fettle::app
