#pragma once

#include <cstdint>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

// Which samples of a field were filled: those with a height where the scan that it began with has a hole. Nothing but
// filling gives a hole a height, so that a session, which has that scan, states it without a layer of its own, through
// filters, marks, undo and replay alike. `original` has the field's sides.

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
