#include "app/commands/shards/submit_script.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "app/commands/shards/plan.h"
#include "app/commands/shards/shard_folder.h"
#include "app/commands/shell_word.h"
#include "engine/field/tile.h"
#include "engine/shard/bands.h"

namespace fettle::app {

namespace {

// What is asked for is twice what was foreseen and two minutes: a queue ends what takes more.
std::string timeText(double seconds) {
  const auto minutes = static_cast<std::int64_t>(std::ceil(2.0 * seconds / 60.0)) + 2;
  return fmt::format("{}:{:02}:00", minutes / 60, minutes % 60);
}

// A tenth more than was foreseen.
std::int64_t megabytesToAsk(double bytes) {
  return static_cast<std::int64_t>(std::ceil(1.1 * bytes / 1e6));
}

// A path that sbatch writes to: % begins what it replaces.
std::string logWord(const std::string& path, const std::string& end) {
  std::string escaped;
  for (const char c : path) escaped += c == '%' ? std::string("%%") : std::string(1, c);
  return quotedWord(escaped + end);
}

std::string slurmScript(const ShardPlan& plan, const SubmitOptions& options, const ShardNeeds& needs,
                        const std::string& shard, const std::string& gather) {
  const ShardFolder folder(plan.out);
  const std::string more = options.more.empty() ? std::string() : options.more + " ";
  // Slurm bounds the numbers of an array: of more shards each task does several, one after another.
  const int tasks = std::min(plan.shards, options.tasks), each = (plan.shards + tasks - 1) / tasks;
  const std::string work =
      each == 1 ? shard + " --shard auto"
                : fmt::format(
                      "failed=0; for k in $(seq $SLURM_ARRAY_TASK_ID {} {}); do {} --shard $k/{} || "
                      "failed=1; done; exit $failed",
                      tasks, plan.shards, shard, plan.shards);
  const GatherNeeds of_gather = needsOfGather(plan);
  return fmt::format(
             "shards=$(sbatch --parsable --job-name=fettle --array=1-{}{} --cpus-per-task={} --mem={}M \\\n"
             "  --time={} --output={} {}--wrap {})\n",
             tasks, options.at_once > 0 ? fmt::format("%{}", options.at_once) : "", needs.threads,
             megabytesToAsk(needs.memory_bytes), timeText(needs.seconds * each),
             logWord(folder.path(), "/log-%a.txt"), more, quotedWord(work)) +
         "# After the last one, however it ended: what is missing is named.\n" +
         fmt::format(
             "gather=$(sbatch --parsable --job-name=fettle-gather --dependency=afterany:\"$shards\" \\\n"
             "  --mem={}M --time={} --output={} {}--wrap {})\n",
             megabytesToAsk(of_gather.memory_bytes), timeText(of_gather.seconds),
             logWord(plan.out, ".gather.txt"), more, quotedWord(gather)) +
         "echo \"$shards $gather\"\n";
}

std::string mpiScript(const ShardPlan& plan, const SubmitOptions& options, const std::string& shard,
                      const std::string& gather) {
  // A rank that ends with an error is no reason to end the others.
  return fmt::format(
             "OMPI_MCA_orte_abort_on_non_zero_status=0 OMPI_MCA_orte_enable_recovery=1 \\\n"
             "  mpirun -n {} {}{} --shard auto --quiet || true\n",
             plan.shards, options.more.empty() ? std::string() : options.more + " ", shard) +
         gather + "\n";
}

std::string localScript(const ShardPlan& plan, const SubmitOptions& options, const std::string& shard,
                        const std::string& gather) {
  const ShardFolder folder(plan.out);
  // The number is an argument of its own: braces in a path are no place for it.
  const std::string one = fmt::format("{} --shard \"$1\"/{} --quiet 2>{}/log-\"$1\".txt", shard, plan.shards,
                                      quotedWord(folder.path()));
  return fmt::format("seq 1 {} | xargs -P {} -n 1 sh -c {} shard || true\n", plan.shards,
                     std::max(options.at_once, 1), quotedWord(one)) +
         gather + "\n";
}

}  // namespace

ShardNeeds needsOf(const ShardPlan& plan, int threads) {
  const int of_shard = threads != 0 ? threads : plan.threads;
  const double more = std::max(of_shard - plan.threads, 0);
  // More threads than were measured may all wait for the memory: no time is taken off for them.
  return {of_shard, plan.seconds * std::max(1.0, static_cast<double>(plan.threads) / of_shard),
          static_cast<double>(plan.memory_bytes) + engine::kBandThreadBytes * more};
}

GatherNeeds needsOfGather(const ShardPlan& plan) {
  constexpr double kProgram = 150e6, kBytesPerSecond = 50e6;
  const double samples = static_cast<double>(plan.width) * plan.height;
  // Rows on their way in and out; the field where its format is written as a whole.
  double bytes = kProgram + 2.0 * sizeof(float) * plan.width * engine::kTileSide;
  if (!writesPlainTiff(plan.out, plan.settings)) bytes += engine::kFieldBytes * samples;
  return {sizeof(float) * samples / kBytesPerSecond, bytes};
}

std::string submitScript(const ShardPlan& plan, const SubmitOptions& options) {
  std::string shard = quotedWord(options.program);
  const int threads = needsOf(plan, options.threads).threads;
  for (const std::string& word : shardWords(plan.command, plan.arguments, threads))
    (shard += ' ') += quotedWord(word);
  const std::string gather = fmt::format("{} gather {}", quotedWord(options.program), quotedWord(plan.out));
  std::string script =
      fmt::format("#!/bin/sh\n# {} shards of a scan, made by fettle submit.\nset -e\ncd {}\n", plan.shards,
                  quotedWord(plan.folder));
  switch (options.engine) {
    case ShardEngine::kSlurm:
      return script + slurmScript(plan, options, needsOf(plan, options.threads), shard, gather);
    case ShardEngine::kMpi:
      return script + mpiScript(plan, options, shard, gather);
    case ShardEngine::kLocal:
      return script + localScript(plan, options, shard, gather);
  }
  return script;
}

}  // namespace fettle::app
