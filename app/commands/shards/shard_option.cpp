#include "app/commands/shards/shard_option.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <thread>

#include <fmt/format.h>

#include "app/commands/resume_option.h"
#include "engine/shard/bands.h"

namespace fettle::app {

void addShardOptions(Command command, ShardOptions& options) {
  command.add(
      {{.name = "--shard",
        .to = &options.shard,
        .text =
            "Do one of several parts alone, K of N from 1 on: of one scan its band of rows, planned before "
            "by "
            "fettle plan; with --out-dir its share of the scans. auto: as Slurm's array, srun or mpirun says",
        .shown = "K/N"},
       {.name = "--shards-in-turn",
        .to = &options.in_turn,
        .text = "Work on bands of one scan one after another, so that the field is never in memory as a "
                "whole; the "
                "same command continues after a cut"},
       {.name = "--memory",
        .to = &options.memory,
        .text = "With --shards-in-turn: the most memory to take, as 2GB or 512MB",
        .shown = "SIZE",
        .otherwise = "half of what is available"}},
      kLongWork);
}

void addListShardOptions(Command command, std::string& shard, std::string& folder) {
  command.add(
      {{.name = "--shard",
        .to = &shard,
        .text = "Of several scans do one of N shares alone, K of N from 1 on. auto: as Slurm's array, "
                "srun or mpirun says",
        .shown = "K/N"},
       {.name = "--shard-dir",
        .to = &folder,
        .text = "With --shard: where its report goes, for fettle gather",
        .kind = ValueKind::kFolder}},
      "Shards");
}

engine::Status checkListShard(const std::string& shard, const std::string& folder) {
  if (shard.empty() == folder.empty()) return {};
  return engine::inputError("a share of the scans has a report of its own",
                            shard.empty() ? "--shard" : "--shard-dir",
                            "give both --shard K/N and --shard-dir FOLDER");
}

void addPlanOptions(Command command, PlanOptions& options) {
  command.add(
      {{.name = "--shards",
        .to = &options.shards,
        .text = "Number of parts, each for a process that may run on another machine",
        .range = Range{1.0, 262144.0},
        .otherwise = "",
        .required = true},
       {.name = "--result",
        .to = &options.result,
        .text = "Where the shards write to",
        .words = {{"auto", "one-file where OUT is a TIFF without compression and its file system can"},
                  {"one-file", "rows of one file that is there from the beginning"},
                  {"files", "a TIFF for each shard, which fettle gather puts together"}}},
       {.name = "--again",
        .to = &options.again,
        .text = "Replace another plan for OUT, with what its shards did"}},
      "Shards");
}

engine::Result<std::uint64_t> parseMemory(const std::string& typed) {
  struct Unit {
    std::string_view word;
    double bytes;
  };
  constexpr std::array<Unit, 8> kUnits{{{"", 1.0},
                                        {"b", 1.0},
                                        {"mb", 1e6},
                                        {"gb", 1e9},
                                        {"tb", 1e12},
                                        {"mib", 1048576.0},
                                        {"gib", 1073741824.0},
                                        {"kb", 1e3}}};
  double number = 0.0;
  const char* const end = typed.data() + typed.size();
  const auto [rest, error] = std::from_chars(typed.data(), end, number);
  std::string unit;
  for (const char* c = rest; c != end; ++c)
    if (*c != ' ') unit += static_cast<char>(*c >= 'A' && *c <= 'Z' ? *c - 'A' + 'a' : *c);
  const auto* const known = std::ranges::find(kUnits, unit, &Unit::word);
  const double bytes = known != kUnits.end() ? number * known->bytes : 0.0;
  if (error != std::errc() || !std::isfinite(bytes) || bytes < 1e6 || bytes > 1e18)
    return engine::inputError(fmt::format("{} is not an amount of memory", typed), "--memory",
                              "give one as 2GB, 512MB or 1.5GiB");
  return static_cast<std::uint64_t>(bytes);
}

int usableCores() noexcept {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

engine::Status checkShardOptions(const ShardOptions& options) {
  if (!options.shard.empty() && options.in_turn)
    return engine::inputError("one shard and all in turn contradict each other", "--shards-in-turn",
                              "give one of them");
  if (!options.memory.empty() && !options.in_turn)
    return engine::inputError("memory is bounded by working in bands", "--memory", "add --shards-in-turn");
  return {};
}

}  // namespace fettle::app
