#pragma once

#include <cstdint>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/moved_form.h"
#include "engine/field/version.h"

namespace fettle::engine {

// The form over a field goes along with its samples to other places.

/// The form over a field (formOfHeights()) at the new places of width x height samples: none without a form, and where movedForm() has none.
[[nodiscard]] std::optional<NominalForm> formAlong(const Version& field, const PlaceMap& places,
                                                   std::int32_t width, std::int32_t height);

/// Samples, with no form over them, as they are seen under one; without it themselves. Errors and thread as SeenField::of().
[[nodiscard]] Result<Version> seenUnder(const Version& samples, const std::optional<NominalForm>& form,
                                        JobControl& job);

/// What is to be seen under a form, and the samples that are seen so: seen + form, rounded to float once, a difference beyond its range
/// the largest float. What is seen of the result is `seen` but for that rounding. The result has no multiple of counts.
/// Errors: kFailed without memory; kCancelled. Thread: any; a long job on all workers of the arena.
[[nodiscard]] Result<Version> raisedUnder(const Version& seen, const NominalForm& form, JobControl& job);

}  // namespace fettle::engine
