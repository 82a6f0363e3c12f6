#pragma once

#include <cstdint>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/nominal_form.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"

namespace fettle::engine {

/// What of a surface a filter leaves.
enum class Waves : std::uint8_t {
  kLong,   ///< what the filter makes of it: an S-filter removes noise and small detail
  kShort,  ///< the surface less that: an L-filter removes waviness
};

/// An S- or L-filter (ISO 25178-3): a filter of the catalogue about `about`, or unless given the least-squares plane of all samples, so
/// that a tilted or bent surface keeps its ends. Holes, marks, edge lines and the field's place stay. Marked samples are filtered as others, as marks choose what
/// is measured. Edge lines are no walls.
///
/// Error: that of the filter (filter.h) on heights about the plane, and two roundings of these to float. Bit-identical
/// for any number of threads. `report`, unless null, becomes the filter's. Memory: that of the filter, and two fields. Errors: as validate(filter, grid); kFailed without
/// memory; kCancelled. Thread: any; a long job on all workers.
[[nodiscard]] Result<Version> scaleFiltered(const Version& field, const FilterSpec& filter, Waves waves,
                                            JobControl& job, FilterReport* report = nullptr,
                                            const NominalForm* about = nullptr);

}  // namespace fettle::engine
