#pragma once

#include <cstdint>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/compare/compare.h"
#include "engine/field/version.h"
#include "engine/measure/rigid_motion.h"
#include "engine/nominal/nominal_mesh.h"

namespace fettle::engine {

/// What lies between a sample and the nominal.
enum class NominalDistance : std::uint8_t {
  kVertical,  ///< height less that of the topmost surface there
  kShortest,  ///< to the nearest place of the mesh, above 0 outside
};

struct NominalOptions {
  NominalDistance distance = NominalDistance::kVertical;
  std::optional<double>
      tolerance;  ///< counts what lies within it on both sides [height unit of the part]; >= 0
};

/// How a part deviates from its nominal: above 0 where the part has more. Lengths in the height unit of the part; NaN
/// without a sample (kNoFigure).
struct NominalDeviation {
  Version field;                ///< at the part's samples; a hole at its holes and where there is no nominal
  std::int64_t samples = 0;     ///< that have a figure
  std::int64_t no_nominal = 0;  ///< samples of the part under or over no triangle: they count in nothing else
  std::int64_t unmeasured = 0;  ///< holes of the part where there is a nominal
  double mean = kNoFigure, rms = kNoFigure;  ///< sqrt(mean(d^2)): the mean is not subtracted
  double min = kNoFigure, max = kNoFigure, max_abs = kNoFigure;
  double p99 = kNoFigure;  ///< as Deviation::p99, of the deviations as stored in `field`
  std::int64_t within = 0, above = 0, below = 0;  ///< of the tolerance
  std::int64_t face_down = 0;                     ///< samples over a triangle that is seen from its inside
  /// Most of the mesh is seen from its inside: it is wound the other way round, and outside was taken as inside.
  bool turned = false;
};

/// Deviation of a part from a nominal that `motion` brings from its own coordinates to the part's. Sign of the version
/// applied. Means are sums of doubles in two-part precision; the field is rounded to float once. A sample has a nominal where a
/// triangle lies over or under it, for both distances, so that both have the same samples.
/// Cost: some microseconds per sample on one core over a million triangles, more for samples far from the mesh. Errors: kInput for
/// a tolerance below 0; kFailed without memory; kCancelled. Thread: any; a long job on all workers of the calling arena;
/// bit-identical for any number of them.
[[nodiscard]] Result<NominalDeviation> deviationFromNominal(const Version& part, const NominalMesh& nominal,
                                                            const RigidMotion& motion,
                                                            const NominalOptions& options, JobControl& job);

/// Where the files place a nominal: its coordinates are those of the part's world. Where it then lies wholly beside the
/// part, millimetres from the part's lower left sample, as a mesh stores them that Fettle wrote of a scan far from zero.
/// Nothing where both do not overlap.
enum class NominalPlace : std::uint8_t { kWorld, kFromCorner };
struct PlacedNominal {
  RigidMotion motion;
  NominalPlace place = NominalPlace::kWorld;
};
[[nodiscard]] std::optional<PlacedNominal> placedAsStored(const NominalMesh& nominal,
                                                          const Grid& part) noexcept;

}  // namespace fettle::engine
