#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/live_field.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"
#include "engine/measure/line_offsets.h"

namespace fettle::engine {

/// The field with its lines levelled in these tiles: z less what is taken, signs applied, rounded to float once, as lowered()
/// has it, into tiles of the field's own memory; all else stays shared. Errors: kFailed without memory; kCancelled. Thread: any.
[[nodiscard]] Result<Version> levelledLines(const Version& field, const LineOffsets& offsets,
                                            const TileRange& tiles, JobControl& job);

/// The same into `to`, a field that began as this one.
[[nodiscard]] Status levelLines(const Version& field, const LineOffsets& offsets, const TileRange& tiles,
                                LiveField& to, JobControl& job);

}  // namespace fettle::engine
