#include "app/commands/shards/submit_script.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <string_view>

#include <fmt/format.h>

#include "app/commands/shards/shard_folder.h"

namespace fettle::app {

namespace {

// What is asked for is twice what was foreseen and two minutes, and a tenth more memory: a queue ends what takes more.
std::string timeText(double seconds) {
  const auto minutes = static_cast<std::int64_t>(std::ceil(2.0 * seconds / 60.0)) + 2;
  return fmt::format("{}:{:02}:00", minutes / 60, minutes % 60);
}

std::string slurmScript(const ShardPlan& plan, const SubmitOptions& options, const std::string& shard,
                        const std::string& gather) {
  const ShardFolder folder(plan.out);
  const std::string more = options.more.empty() ? std::string() : options.more + " ";
  const auto memory =
      static_cast<std::int64_t>(std::ceil(1.1 * static_cast<double>(plan.memory_bytes) / 1e6));
  const auto logged = [&](const char* which) { return quotedWord(folder.path() + "/log-" + which + ".txt"); };
  return fmt::format(
             "shards=$(sbatch --parsable --job-name=fettle --array=1-{}{} --cpus-per-task={} --mem={}M \\\n"
             "  --time={} --output={} {}--wrap {})\n",
             plan.shards, options.at_once > 0 ? fmt::format("%{}", options.at_once) : "", options.threads,
             memory, timeText(plan.seconds), logged("%a"), more, quotedWord(shard + " --shard auto")) +
         "# After the last one, however it ended: what is missing is named.\n" +
         fmt::format(
             "gather=$(sbatch --parsable --job-name=fettle-gather --dependency=afterany:\"$shards\" \\\n"
             "  --mem={}M --time={} --output={} {}--wrap {})\n",
             200, timeText(plan.seconds), quotedWord(plan.out + ".gather.txt"), more, quotedWord(gather)) +
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
  const std::string one = fmt::format("{} --shard {{}}/{} --quiet 2>{}/log-{{}}.txt", shard, plan.shards,
                                      quotedWord(folder.path()));
  return fmt::format("seq 1 {} | xargs -P {} -I{{}} sh -c {} || true\n", plan.shards,
                     std::max(options.at_once, 1), quotedWord(one)) +
         gather + "\n";
}

}  // namespace

std::string quotedWord(const std::string& word) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("/._-+=:,@").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::ranges::all_of(word, plain)) return word;
  std::string out = "'";
  for (const char c : word)
    if (c == '\'')
      out += "'\\''";
    else
      out += c;
  return out + "'";
}

std::string submitScript(const ShardPlan& plan, const SubmitOptions& options) {
  std::string shard = quotedWord(options.program);
  for (const std::string& word : plan.arguments) (shard += ' ') += quotedWord(word);
  if (std::ranges::none_of(plan.arguments,
                           [](const std::string& word) { return word.starts_with("--threads"); }) &&
      plan.command == "filter")
    shard += fmt::format(" --threads {}", options.threads);
  const std::string gather = fmt::format("{} gather {}", quotedWord(options.program), quotedWord(plan.out));
  std::string script =
      fmt::format("#!/bin/sh\n# The {} shards of {}, made by fettle submit.\nset -e\ncd {}\n", plan.shards,
                  plan.out, quotedWord(plan.folder));
  switch (options.engine) {
    case ShardEngine::kSlurm:
      return script + slurmScript(plan, options, shard, gather);
    case ShardEngine::kMpi:
      return script + mpiScript(plan, options, shard, gather);
    case ShardEngine::kLocal:
      return script + localScript(plan, options, shard, gather);
  }
  return script;
}

}  // namespace fettle::app
