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
/// `replaces`: more that the command replaces with it, ", and ...".
void addForceOption(Command command, Replacing& replacing, const std::string& replaces = {});

/// checkPlaces() for a command, which cannot ask: also refuses to replace a session that has a journal,
/// unless `replacing` allows it. Where an output replaces the scan of another session, that session stores
/// the scan first, with a warning (ScanGuard).
[[nodiscard]] engine::Status checkOutputs(const std::vector<Output>& outputs,
                                          const std::vector<std::string>& inputs, Replacing replacing,
                                          engine::JobControl& job);

}  // namespace fettle::app
