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
  int threads = 0;      ///< cores of a shard; 0: as it was planned with
  int tasks = 1000;     ///< of Slurm's array, at most
  std::string more;     ///< further words for sbatch or mpirun
  std::string program;  ///< path of fettle
};

/// What one shard takes, as foreseen.
struct ShardNeeds {
  int threads = 1;
  double seconds = 0.0;
  double memory_bytes = 0.0;
};
/// With so many threads; 0: as it was planned with.
[[nodiscard]] ShardNeeds needsOf(const ShardPlan& plan, int threads);

/// What gathering takes: it reads, and of shards with files of their own writes, every sample once.
struct GatherNeeds {
  double seconds = 0.0;
  double memory_bytes = 0.0;
};
[[nodiscard]] GatherNeeds needsOfGather(const ShardPlan& plan);

/// A shell script that does all shards of a plan and gathers them. Shards that are done are not done again, and one that fails does
/// not stop the others: the same script continues.
[[nodiscard]] std::string submitScript(const ShardPlan& plan, const SubmitOptions& options);

}  // namespace fettle::app
