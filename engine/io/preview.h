#pragma once

#include <cstdint>

#include "engine/io/import.h"

namespace fettle::engine {

/// A coarse picture of a raster, shown while the rest is read. Never edited, never saved.
struct Preview {
  /// Every step_columns-th sample of every step_rows-th row, with the corresponding spacing; or the file's
  /// own overview. Holes where the file has holes. Its origin is that of its own lower-left sample.
  Version field;
  std::int32_t step_columns = 1, step_rows = 1;  ///< samples of the file from one of these to the next
  bool overview =
      false;  ///< the file's own: each sample represents those around it by the file's rule, usually their mean, and holes narrower than a step may be missing
  std::int32_t width = 0, height = 0;  ///< of the file
};

}  // namespace fettle::engine
