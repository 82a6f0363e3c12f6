#include "app/commands/shards/band_work.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/commands/shards/band_input.h"
#include "app/commands/shards/band_output.h"
#include "app/commands/shards/gathering.h"
#include "app/commands/shards/launcher.h"
#include "app/commands/shards/shard_folder.h"
#include "app/commands/shards/shard_note.h"
#include "engine/base/memory.h"
#include "engine/base/stopwatch.h"
#include "engine/filter/catalogue.h"
#include "engine/io/files/atomic_file.h"
#include "engine/shard/band_filter.h"
#include "engine/shard/bands.h"

namespace fettle::app {

namespace {

using engine::RowSpan;

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
  // What an earlier run of the same command left counts, with less memory too as long as there is enough for its bands.
  const std::uint64_t available = engine::availableMemory();
  TurnMemory memory{.most = available / 2, .keeps = available};
  if (!options.memory.empty()) {
    const auto given = parseMemory(options.memory);
    if (!given) return tl::unexpected(given.error());
    memory = {.most = *given, .keeps = *given};
  }
  const ShardFolder folder(work.out);
  const std::vector<std::string> words(arguments.begin() + (arguments.empty() ? 0 : 1), arguments.end());
  auto plan = planBands(work, {.shards = 0, .result = "auto", .again = false}, words, memory, job);
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