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

/// Options of commands that only read: of several scans a share, and where its report goes.
void addListShardOptions(Command command, std::string& shard, std::string& folder);
/// Refuses one of them without the other.
[[nodiscard]] engine::Status checkListShard(const std::string& shard, const std::string& folder);

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
