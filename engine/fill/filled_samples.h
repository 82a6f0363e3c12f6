#pragma once

#include <cstdint>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

// Which samples of a field were filled: those with a height where the scan that it began with has a hole. Nothing but
// filling gives a hole a height, so that a session, which has that scan, states it without a layer of its own, through
// filters, marks, undo and replay alike. `original` has the field's sides. Samples that were removed and filled have a height in
// that scan: withoutReplaced() takes it away for those who ask, so that they are filled ones like others.

/// The scan that a session began with as far as it was measured: without the heights that were removed and filled since.
/// A hole also where `between`, a state after it, has one and `field`, a later state, has a height. Shares all other tiles; the same
/// version where there is no such sample. Errors: kCancelled, kFailed without memory.
[[nodiscard]] Result<Version> withoutReplaced(const Version& original, const Version& between,
                                              const Version& field, JobControl& job);

/// How many. A look at each tile with holes. Thread: any.
[[nodiscard]] std::int64_t countFilled(const Version& field, const Version& original);

/// The field with holes in place of these samples: what was measured. Shares all other tiles. Errors: kCancelled, kFailed
/// without memory.
[[nodiscard]] Result<Version> withoutFilled(const Version& field, const Version& original, JobControl& job);

/// The field with these samples marked, beside those that are or, as wanted, alone. Errors as withoutFilled.
enum class OtherMarks : std::uint8_t { kStay, kGo };
[[nodiscard]] Result<Version> withFilledMarked(const Version& field, const Version& original,
                                               OtherMarks others, JobControl& job);

}  // namespace fettle::engine
