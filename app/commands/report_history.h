#pragma once

#include "app/commands/report_draft.h"
#include "engine/base/error.h"

namespace fettle::app {

/// Adds what the figures depend on besides the samples: the options; of a session also what made its scan, how it was touched,
/// and its steps with their hashes. Errors: as loadSession.
[[nodiscard]] engine::Status addWork(ReportDraft& draft);

}  // namespace fettle::app
