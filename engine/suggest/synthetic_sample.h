#pragma once

#include <cstdint>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// A synthetic scan similar to a piece of a scan, with its surface, so that filters can be tried where the
/// truth is known.
struct SyntheticSample {
  Version surface;  ///< the piece without its noise and outliers: what a filter should find
  Version scan;     ///< the surface with added noise of the same size, and the piece's own outliers
  Version edges;    ///< the surface with its edge lines marked, as findEdges finds them in the piece
  std::int64_t outliers = 0;
};

/// Makes a synthetic sample of a piece whose noise has the standard deviation `sigma` [height_unit, > 0].
///
///   piece --outliers out--> --bilateral 7, tv 41--> surface --white noise, outliers in--> scan
///
/// An outlier is a sample that lies more than 6 sigma above or below all of its neighbours.
/// Noise of the piece that remains after smoothing, 0.2 sigma or less on flats, counts as surface; details
/// that the smoothing removed, small creases first, are missing from it. The added noise is white and
/// Gaussian, which a scanner's is only approximately. Marks of the piece stay in `scan`. Bit-identical for
/// the same seed. Errors: cancelled; memory (kFailed). Throws std::bad_alloc.
[[nodiscard]] Result<SyntheticSample> makeSyntheticSample(const Version& piece, double sigma,
                                                          std::uint64_t seed, JobControl& job);

}  // namespace fettle::engine
