#pragma once

#include <functional>
#include <optional>
#include <string>

#include "engine/base/error.h"
#include "engine/shard/bands.h"

namespace fettle::app {

/// A variable of the environment, or null.
using Environment = std::function<const char*(const char* name)>;

/// The shard that a launcher gave this process: of a task array of Slurm (SLURM_ARRAY_TASK_ID with _COUNT, _MIN and _STEP), of
/// Open MPI (OMPI_COMM_WORLD_RANK, _SIZE), of another MPI (PMI_RANK, PMI_SIZE), of a step of srun (SLURM_PROCID,
/// SLURM_NTASKS). Launchers with one task say nothing beside another with more; MPI counts within a step of
/// Slurm, whose own numbers are then those of nodes. Nothing where there is no launcher. Errors (kInput): a number that is
/// none, one without its count, outside of it, or two launchers that contradict each other.
[[nodiscard]] engine::Result<std::optional<engine::Shard>> shardOfLauncher(const Environment& environment);

/// "2/7", counted from 1; "2" of `planned` shards; "auto": shardOfLauncher. Errors (kInput): not of these, a number outside 1 to
/// the count, another count than `planned` (0: none is known yet), a launcher that is missing.
[[nodiscard]] engine::Result<engine::Shard> parseShard(const std::string& typed, int planned,
                                                       const Environment& environment);

/// The variables of this process.
[[nodiscard]] const char* variableOfProcess(const char* name);

}  // namespace fettle::app
