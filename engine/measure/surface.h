#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/nominal_form.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"
#include "engine/measure/region.h"

namespace fettle::engine {

/// The samples of a region about their form, as one array: what parameters that need more than neighbours are taken of.
struct Surface {
  std::int32_t width = 0, height = 0;  ///< of the least rectangle around the region's samples [samples]
  std::int32_t first_column = 0, first_row = 0;  ///< of that rectangle in the field
  double spacing_x = 1.0, spacing_y = 1.0;       ///< [mm]
  double height_mm = 1.0;                        ///< millimetres in a height unit
  std::int64_t samples = 0;                      ///< that are no holes
  std::vector<float>
      heights;  ///< row-major, less form and mean [height_unit]; NaN: a hole, or not of the region

  [[nodiscard]] float at(std::int32_t column, std::int32_t row) const noexcept {
    return heights[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(column)];
  }
};

/// Reads it: heights less `form` and less `mean`, rounded to float once. A region without samples is a surface of none.
/// Memory: 4 bytes per sample of the rectangle. Errors: kCancelled. Throws std::bad_alloc. Thread: any; on all workers of
/// the calling arena.
[[nodiscard]] Result<Surface> surfaceOf(const Version& field, const NominalForm& form, double mean,
                                        Region region, JobControl& job);

}  // namespace fettle::engine
