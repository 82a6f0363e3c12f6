#pragma once

#include <string>
#include <vector>

#include "app/commands/region_option.h"
#include "app/work/work_estimate.h"
#include "engine/base/error.h"
#include "engine/field/grid.h"
#include "engine/field/version.h"
#include "engine/remove/remove.h"

namespace fettle::app {

/// Which samples `fettle remove` and the step "remove" of a recipe make holes of. Heights as typed, with a sign; empty: none.
struct RemoveArguments {
  std::string below, above;
  std::vector<std::string> between;  ///< two, or none
  std::string region;                ///< of removeWords(); empty: unmarked
};

/// Which of these: "unmarked", "marked", "all", and shapes, of which marked samples go, too.
[[nodiscard]] std::vector<Word> removeWords();

/// Errors (kInput): nothing that chooses, heights that exclude each other or are none, limits that are no interval.
[[nodiscard]] engine::Result<engine::RemoveOptions> removeOptionsOf(const RemoveArguments& arguments,
                                                                    const engine::Grid& grid);

/// Makes holes: engine::removeSamples() of `counted`, what countedOf() made of `field` for the region. What is left keeps the marks
/// of `counted`, of a shape those of `field`. `scan` is its path. Errors: as engine::removeSamples, naming the scan.
[[nodiscard]] engine::Result<engine::Removed> removedFrom(const engine::Version& field,
                                                          const engine::Version& counted,
                                                          const std::string& region,
                                                          const engine::RemoveOptions& options,
                                                          const std::string& scan, engine::JobControl& job);

/// The work for an estimate. The field lives as long as what is returned.
[[nodiscard]] PlannedOnPieces plannedRemove(const engine::Version& field,
                                            const engine::RemoveOptions& options);

}  // namespace fettle::app
