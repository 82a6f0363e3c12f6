#pragma once

#include "app/commands/report_draft.h"
#include "engine/base/error.h"

namespace fettle::app {

/// Adds the surface texture of each state about its form, with standard errors, and its curves. Errors: those of measuring and
/// drawing; curves that cannot be drawn are a sentence in their place.
[[nodiscard]] engine::Status addTextureAndCurves(ReportDraft& draft);

}  // namespace fettle::app
