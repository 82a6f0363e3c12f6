#pragma once

#include "app/commands/report_draft.h"
#include "engine/base/error.h"

namespace fettle::app {

// What a report says of a scan besides what is measured of its surface.

/// Finds the change from before to after, where there are two states; the colours of pictures follow it, too.
[[nodiscard]] engine::Status compareStates(ReportDraft& draft);
/// Adds its size, and heights and noise of each state.
[[nodiscard]] engine::Status addScanFacts(ReportDraft& draft);
/// Adds the figures of compareStates().
[[nodiscard]] engine::Status addChange(ReportDraft& draft);

}  // namespace fettle::app
