#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/early_picture.h"
#include "engine/field/field_view.h"
#include "engine/field/version.h"
#include "engine/measure/line_offsets.h"

namespace fettle::engine {

/// Levels the lines that are seen, so that there is a picture before all lines are levelled by all of their samples.
///
/// Offsets come from some millions of samples, one at random in each stretch of a line, at the same places in all lines. How far
/// the heights are off is estimated by how far offsets of every other of these are off them: of independent samples the variance
/// of that difference is the one that is asked for, but for the share of samples looked at, which is counted in. Where much of the
/// field is in view, the picture is the field of its means, less the means of what is taken.
///
/// Calls `show` once; not at all without a view, or where the whole takes no longer. Errors: those of findLineOffsets. Thread: any; a job on all workers of
/// the arena, tenths of a second for 105 million samples.
[[nodiscard]] Status showLevelled(const Version& field, const LineOptions& options, const FieldView& view,
                                  const ShowEarly& show, JobControl& job);

}  // namespace fettle::engine
