#include "app/commands/output_checks.h"

#include "app/work/memory_places.h"
#include "app/work/open_document.h"
#include "app/work/session_guard.h"
#include "app/work/streams.h"

namespace fettle::app {

void addForceOption(Command command, Replacing& replacing, const std::string& replaces) {
  command.add({{.name = "--force",
                .to = [&replacing] { replacing = Replacing::kAnything; },
                .text = "Replace a session that has a journal" + replaces}});
}

engine::Status checkOutputs(const std::vector<Output>& outputs, const std::vector<std::string>& inputs,
                            Replacing replacing, engine::JobControl& job) {
  if (auto status = checkPlaces(outputs, inputs); !status) return status;
  if (replacing == Replacing::kNoWork)
    for (const Output& output : outputs)
      if (isSessionPath(output.path))
        if (auto status = refuseToLoseWork(output.path); !status) return status;
  ScanGuard guard;
  for (const Output& output : outputs)
    if (!output.path.empty() && !isStream(output.path) && memoryPlace(output.path) == nullptr)
      if (auto status = guard.protectSessions(output.path, job); !status) return status;
  return {};
}

}  // namespace fettle::app
