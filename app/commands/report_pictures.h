#pragma once

#include "app/commands/report_draft.h"
#include "engine/base/error.h"

namespace fettle::app {

/// Adds pictures of the states from the side and from above, and of their change. Errors: as render::LivePicture::create and
/// drawPicture.
[[nodiscard]] engine::Status addPictures(ReportDraft& draft);

}  // namespace fettle::app
