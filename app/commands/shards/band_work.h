#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/shards/shard_option.h"
#include "app/commands/shards/shard_plan.h"
#include "app/report.h"
#include "app/work/scan_reading.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/filter/filter.h"
#include "engine/io/export.h"

namespace fettle::app {

/// Work on one scan that can be divided into bands: what a command was told.
struct BandWork {
  std::string command;                       ///< filter or convert
  std::optional<engine::FilterSpec> spec{};  ///< without range and limit, which are typed in the scan's unit
  std::string range_sigma{}, max_change{};
  std::string keep{}, only{}, lines{}, original{};
  ScanOptions reading{};
  engine::ExportOptions writing{};
  std::string in{}, out{};
};

/// Memory of bands that one process works on one after another [bytes].
struct TurnMemory {
  std::uint64_t most = 0;   ///< of which no band, and no reading, takes more
  std::uint64_t keeps = 0;  ///< bands of an earlier run are kept that take this or less
};

/// Finds what is global of a field - its grid, the noise's range, a limit in its unit -, makes what the shards write to and
/// writes the plan. The same plan again changes nothing. `arguments`: of the program as typed. `memory`: the bands
/// are worked on in turn, in so many as it needs; a plan of such an earlier run is replaced where its bands cannot be kept. Errors: a filter that needs the whole field with more than one shard, an OUT that cannot be put
/// together, another plan for it; with `memory` an OUT that is no plain TIFF; of reading and writing.
[[nodiscard]] engine::Result<ShardPlan> planBands(const BandWork& work, const PlanOptions& options,
                                                  const std::vector<std::string>& arguments,
                                                  const std::optional<TurnMemory>& memory,
                                                  engine::JobControl& job);

/// Does one shard as it was planned. One that is done already is not done again. Its rows are whole on the disk before its report is.
/// Errors: no plan, or one for other options or another input; as the command.
[[nodiscard]] engine::Result<Report> runBand(const BandWork& work, const std::string& shard,
                                             engine::JobControl& job);

/// All bands one after another in this process, in so many that none takes more than the memory, and what gatherBands() does.
[[nodiscard]] engine::Result<Report> runBandsInTurn(const BandWork& work, const ShardOptions& options,
                                                    const std::vector<std::string>& arguments,
                                                    engine::JobControl& job);

}  // namespace fettle::app
