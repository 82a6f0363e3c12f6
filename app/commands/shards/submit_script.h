#pragma once

#include <string>

#include "app/commands/shards/shard_plan.h"

namespace fettle::app {

/// Who starts the shards.
enum class ShardEngine {
  kSlurm,  ///< a task array and a job after it, by sbatch
  kMpi,    ///< one rank for each shard, by mpirun
  kLocal,  ///< processes of this machine, by xargs
};

struct SubmitOptions {
  ShardEngine engine = ShardEngine::kLocal;
  int at_once = 0;      ///< shards that run at the same time; 0: all (local: one for each core)
  int threads = 1;      ///< cores of a shard
  std::string more;     ///< further words for sbatch or mpirun
  std::string program;  ///< path of fettle
};

/// A shell script that does all shards of a plan and gathers them. Shards that are done are not done again, and one that fails does
/// not stop the others: the same script continues.
[[nodiscard]] std::string submitScript(const ShardPlan& plan, const SubmitOptions& options);

/// A word as the shell takes it.
[[nodiscard]] std::string quotedWord(const std::string& word);

}  // namespace fettle::app
