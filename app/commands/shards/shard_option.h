#pragma once

#include <optional>
#include <string>

#include "app/commands/command.h"

namespace fettle::app {

/// Options of commands whose work can be divided.
struct ShardOptions {
  std::string shard;     ///< --shard as typed; empty: all the work
  bool in_turn = false;  ///< --shards-in-turn
  std::string memory;    ///< --memory as typed
};
void addShardOptions(Command command, ShardOptions& options);

/// Of `fettle plan`.
struct PlanOptions {
  int shards = 0;
  std::string result = "auto";
  bool again = false;
};
void addPlanOptions(Command command, PlanOptions& options);

/// "2GB", "512MB", "1.5 GiB" in bytes. Errors (kInput) name --memory.
[[nodiscard]] engine::Result<std::uint64_t> parseMemory(const std::string& typed);

/// Cores of this machine, at least 1.
[[nodiscard]] int usableCores() noexcept;

/// Refuses options that contradict each other: --memory without --shards-in-turn, that with --shard.
[[nodiscard]] engine::Status checkShardOptions(const ShardOptions& options);

}  // namespace fettle::app
