#pragma once

#include <string>
#include <vector>

#include "app/commands/command.h"
#include "app/work/outputs.h"

namespace fettle::app {

/// The files that an output may replace.
enum class Replacing {
  kNoWork,   ///< any file but a session that has a journal
  kAnything  ///< --force
};
void addForceOption(Command command, Replacing& replacing);

/// checkPlaces() for a command, which cannot ask: also refuses to replace a session that has a journal,
/// unless `replacing` allows it. Where an output replaces the scan of another session, that session stores
/// the scan first, with a warning (ScanGuard).
[[nodiscard]] engine::Status checkOutputs(const std::vector<Output>& outputs,
                                          const std::vector<std::string>& inputs, Replacing replacing,
                                          engine::JobControl& job);

}  // namespace fettle::app
