#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "engine/field/grid.h"
#include "engine/field/nominal_form.h"
#include "engine/field/version.h"
#include "engine/mosaic/pose_adjustment.h"

namespace fettle::engine {

/// The form of the first of several scans over their mosaic, and how far those of the others lie from it.
struct CommonForm {
  NominalForm form;          ///< of the mosaic's width and height, in its height unit
  double apart_mm = 0.0;     ///< at most, of 25 x 25 places spread over each of the other scans
  std::size_t farthest = 0;  ///< the scan with that
};

/// `forms`: of each scan's heights, not null; `grid`: of gridOverAll(). A polynomial goes on as one beyond its scan, a shape as itself.
/// None where movedForm() has none of the first. Thread: any.
[[nodiscard]] std::optional<CommonForm> commonForm(const std::vector<Version>& scans,
                                                   const std::vector<FieldForm>& forms,
                                                   const AdjustedPoses& poses, const Grid& grid);

}  // namespace fettle::engine
