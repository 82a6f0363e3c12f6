#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/early_picture.h"
#include "engine/field/field_view.h"
#include "engine/field/version.h"
#include "engine/fill/fill.h"

namespace fettle::engine {

/// Fills holes that are seen, so that there is a picture before fillHoles() has filled all.
///
/// Holes that lie in the view and a margin around it come with the bits of fillHoles(), the nearest to the middle first; some
/// of these are left to it: those that reach farther, those of so many samples that one keeps the others waiting, and of a
/// view of most of the field what is not filled within a second, since that is filled once more with the whole.
///
/// Where much of a large field is in view, the picture is the field of its means, holes of these filled by the same rules: holes
/// within a cell are not seen there, edge lines no wall. How far filled cells are off is measured on the holes nearest to the
/// middle, which are filled for it; where only large ones are there, against the filled means of four cells each.
///
/// Calls `show` with each picture; not at all without a view, without heights, or where nothing in view is filled. Errors: kCancelled; kFailed
/// without memory. Thread: any; a job on all workers of the arena, tenths of a second for 105 million samples.
[[nodiscard]] Status showFilled(const Version& field, const FillOptions& options, const FieldView& view,
                                const ShowEarly& show, JobControl& job);

}  // namespace fettle::engine
