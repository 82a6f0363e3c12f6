#pragma once

#include <cstdint>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// A piece of a scan and a surface that could have been under it, so that filters can be tried where the
/// truth is known.
struct StandIn {
  Version surface;  ///< the piece without its noise and outliers: what a filter should find
  Version scan;     ///< the surface with noise of the same size put on, and the piece's outliers as they were
  Version edges;    ///< the surface with its edge lines marked, as findEdges sees them in the piece
  std::int64_t outliers = 0;
};

/// Makes a stand-in of a piece whose noise has the standard deviation `sigma` [height_unit, > 0].
///
///   piece --outliers out--> --bilateral 7, tv 41--> surface --white noise, outliers in--> scan
///
/// An outlier is a sample that lies more than 6 sigma above or below all of its neighbours.
/// What the smoothing left of the piece's own noise, 0.2 sigma or less on
/// flats, counts as surface; what it took of the surface, small creases first, is missing from it. The noise
/// put on is white and Gaussian, which a scanner's is not in every respect. Marks of the piece stay in
/// `scan`. Same bits each time for the same seed. Errors: cancelled; memory (kFailed). Throws std::bad_alloc.
[[nodiscard]] Result<StandIn> standInOf(const Version& piece, double sigma, std::uint64_t seed,
                                        JobControl& job);

}  // namespace fettle::engine
