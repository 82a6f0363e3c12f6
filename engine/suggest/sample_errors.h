#pragma once

#include <cstdint>
#include <vector>

#include "engine/field/version.h"
#include "engine/suggest/mosaic.h"
#include "engine/suggest/sample_zones.h"
#include "engine/suggest/synthetic_sample.h"

namespace fettle::engine {

/// Errors of a filter on a synthetic sample, as they are to be expected on the scan.
struct SampleErrors {
  double flat = 0.0, edge = 0.0;  ///< root mean square [height_unit]; NaN without such samples
};

/// Which samples of a synthetic sample are flats and which near edges, as compareToTruth has them, and for how many of
/// the scan each stands.
///
/// Pieces of a large scan are taken where it has edges, so that plain places are too few among them. Tiles of 64 x 64
/// of the scan are sorted by their range of heights, in factors of two, and each judged sample counts as often as the
/// scan has samples of its kind per judged one (post-stratification: Holt and Smith 1979).
class SampleJudge {
 public:
  /// `sample` was made of `pieces` of `scan`, whose noise is `sigma`. Throws std::bad_alloc.
  SampleJudge(const Version& scan, const Mosaic& pieces, const SyntheticSample& sample, double sigma);

  /// What counts as an error of the filter.
  enum class Rare : std::uint8_t {
    kCount,
    /// The largest errors, one of 5,000 samples and at most eight, do not count. A filter that looks for lone samples
    /// takes tips of ribs for some on one scan of twenty, where it finds four of them at least, and a single such sample
    /// is several millimetres off.
    kLeftOut
  };
  /// Of `filtered`, which has the sample's size. Any thread. Throws std::bad_alloc.
  [[nodiscard]] SampleErrors errorsOf(const Version& filtered, Rare rare) const;

  /// Near edges, of those judged; as often as they count.
  [[nodiscard]] double edgeShare() const noexcept { return edge_share_; }

 private:
  std::vector<float> surface_;
  std::vector<SampleZone> zones_;
  std::vector<float> weights_;  // empty: all 1
  double edge_share_ = 0.0;
};

}  // namespace fettle::engine
