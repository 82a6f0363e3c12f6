#pragma once

#include <string>

#include "app/commands/command.h"
#include "app/work/filter_compute.h"
#include "engine/filter/catalogue.h"

namespace fettle::app {

/// --compute auto, cpu or gpu.
void addComputeOption(Command command, std::string& word);

/// Where a filter runs by this word; starts a device where word and filter ask for one. Errors: "gpu" and a filter that
/// runs on the processor alone (kInput) or no device that can do it (kFailed). With "auto" a hardware device that cannot do
/// it is a warning.
[[nodiscard]] engine::Result<FilterCompute> chooseCompute(const std::string& word,
                                                          const engine::Filter& filter);

}  // namespace fettle::app
