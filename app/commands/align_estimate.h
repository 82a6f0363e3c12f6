#pragma once

#include "app/commands/align_option.h"
#include "app/work/work_estimate.h"
#include "engine/field/version.h"
#include "engine/nominal/nominal_mesh.h"

namespace fettle::app {

/// Heights to which alignFields() reduces a larger scan, about.
inline constexpr double kMostAligned = 1 << 20;

/// The search for an alignment, for an estimate. Its time is that of the same search in every n-th sample, which has all
/// resolutions but the finest, that one in proportion to its heights, and the reduction of all samples. What is given lives as long
/// as what is returned.
[[nodiscard]] PlannedOnPieces plannedAlignment(const engine::Version& a, const engine::Version& b,
                                               const AlignArguments& arguments);
/// Of a nominal mesh.
[[nodiscard]] PlannedOnPieces plannedAlignment(const engine::Version& a, const engine::NominalMesh& b,
                                               const AlignArguments& arguments);

}  // namespace fettle::app
