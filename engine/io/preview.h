#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/io/import.h"

namespace fettle::engine {

/// A coarse picture of a raster, to be looked at while the rest is read. Never edited, never saved.
struct Preview {
  /// Every step_columns-th sample of every step_rows-th row, with the spacing of these; or the file's own
  /// overview. Holes where the file has holes. Its origin is that of its own lower-left sample.
  Version field;
  std::int32_t step_columns = 1, step_rows = 1;  ///< samples of the file from one of these to the next
  bool overview = false;  ///< the file's own: each sample stands for those around it by the file's rule,
                          ///< usually their mean, and holes narrower than a step may be gone
  std::int32_t width = 0, height = 0;  ///< of the file
};

/// Reads a coarse picture of at most `max_samples` samples (>= 4), when the file is so large that this is of
/// use - over four times as many - and it can be had for a small share of the whole: a TIFF that is not
/// packed, that has overviews, or whose packed blocks need not all be unpacked. Nothing otherwise: other
/// formats, depth images, a field without a valid height at the samples looked at.
///
/// Cost: at most 24 million samples unpacked, or the rows looked at read. Rows lie farther apart than columns
/// where packed blocks would cost more: their first rows are looked at alone.
///
/// What is left unsaid are the warnings; who reads the whole gets them. Errors: as importField, as far as the
/// file is looked at. Thread: any; reports progress and looks at cancel() in `job`.
[[nodiscard]] Result<std::optional<Preview>> importPreview(const std::string& path,
                                                           const ImportOptions& options,
                                                           std::int64_t max_samples, JobControl& job);

}  // namespace fettle::engine
