#pragma once

#include <string>

#include "app/work/work_estimate.h"
#include "engine/base/error.h"
#include "engine/field/grid.h"
#include "engine/field/version.h"
#include "engine/fill/fill.h"

namespace fettle::app {

/// Which holes `fettle fill` and the step "fill" of a recipe fill, and by what.
struct FillArguments {
  std::string method = "curvature";  ///< or membrane
  std::string most_extent;           ///< a length across the field, as typed; empty: any
  double most_area = 0.0;            ///< [mm^2]; 0: any
  bool at_border = false;
};

/// Errors (kInput): an extent that is no length above 0.
[[nodiscard]] engine::Result<engine::FillOptions> fillOptionsOf(const FillArguments& arguments,
                                                                const engine::Grid& grid);

/// The work for an estimate, in proportion to the samples without a height, around one of them in the middle of all. What is
/// not foreseen: that some holes stay, and that the equations of one hole grow faster than its samples, so that holes
/// larger than a piece take longer. The field lives as long as what is returned.
[[nodiscard]] PlannedOnPieces plannedFill(const engine::Version& field, const engine::FillOptions& options);

}  // namespace fettle::app
