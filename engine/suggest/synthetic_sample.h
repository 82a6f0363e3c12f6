#pragma once

#include <cstdint>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/inspect/height_counts.h"
#include "engine/inspect/noise_model.h"
#include "engine/suggest/mosaic.h"

namespace fettle::engine {

/// A synthetic scan similar to pieces of a scan, with its surface, so that filters can be tried where the
/// truth is known.
struct SyntheticSample {
  /// The pieces without their noise and outliers: what a filter should find. Holes where it is not judged
  /// (Mosaic::Piece::judged).
  Version surface;
  Version scan;   ///< the surface with added noise of the same kind and size, and the pieces' own outliers
  Version edges;  ///< the surface with its edge lines marked (sample_edges.h)
  std::int64_t outliers = 0;
};

/// Makes a synthetic sample of the pieces of a scan of `grid` whose noise is `noise` (sigma > 0) and whose heights are
/// `counts`, as those of the sample then are.
///
///   pieces --outliers out--> --generalised variation--> surface --noise, outliers in--> scan
///
/// An outlier is a sample that lies more than 6 sigma above or below all of its neighbours; where fewer than one of
/// 10,000 is, they stay in the surface. The noise is made of the
/// parts of the model (NoiseSource), at each sample as large as the model's map says, and on flats and near edges so that
/// a filter takes off the sample what it takes off the pieces (noise_match.h). What of the pieces' noise the filter
/// leaves, a tenth of it on flats, counts as surface; details below the noise that it removes are missing. Marks of
/// the pieces stay in `scan`. Bit-identical for the same seed. Errors: cancelled; memory (kFailed). Throws
/// std::bad_alloc.
[[nodiscard]] Result<SyntheticSample> makeSyntheticSample(const Mosaic& pieces, const Grid& grid,
                                                          const NoiseModel& noise, const HeightCounts& counts,
                                                          std::uint64_t seed, JobControl& job);

}  // namespace fettle::engine
