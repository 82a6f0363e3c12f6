#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// How often each change occurs: samples by b - a [height_unit]. Class i of kClasses counts the changes d
/// with lowEnd(i) <= d < lowEnd(i + 1); zero is the border between the two middle ones. Samples that are
/// equal before and after are counted separately, since they are so many.
struct ChangeHistogram {
  static constexpr int kClasses = 64;
  double reach = 0.0;  ///< the classes go from -reach to +reach; a power of two; 0: nothing changed
  std::int64_t unchanged = 0;
  std::array<std::int64_t, kClasses> counts{};

  [[nodiscard]] double lowEnd(int i) const noexcept { return reach * (2.0 * i / kClasses - 1.0); }
};

/// The figures of compareFields that are shown during work, updated at the cost of the changed tiles.
struct LiveFigures {
  std::int64_t samples = 0;  ///< valid in both
  double max_abs = 0.0;      ///< as Deviation; 0 without samples
  double rms = 0.0;
  double sq_original = 0.0, sq = 0.0;  ///< about each field's own plane, as Deviation
  /// About the plane of the ORIGINAL, for both: the present field's plane would have to be known before the
  /// first sample is read. The error is at most sa_plane_shift.
  double sa_original = 0.0, sa = 0.0;
  double sa_plane_shift = 0.0;  ///< mean distance between the two planes, an upper bound
  ChangeHistogram histogram;
};

/// Stores sums of each tile, compared with the original, and adds them again each time: 24,000 tiles (100 M
/// samples) take some milliseconds, a changed tile about 15 us. Sums are in double, tile by tile in a fixed
/// order: the figures do not depend on the edits that led to a version or on the thread count. Memory: 0.1
/// byte per sample. Threading: one thread at a time.
class LiveDeviation {
 public:
  /// Reads all of `original` once. Errors: cancelled, memory exhausted.
  [[nodiscard]] static Result<LiveDeviation> create(const Version& original, JobControl& job);

  /// Figures of `now`: same grid and memory as the original; signs are ignored, both are taken as upright.
  /// Errors: cancelled (nothing has changed then), memory exhausted.
  [[nodiscard]] Result<LiveFigures> update(const Version& now, JobControl& job);

 private:
  struct TileSums {
    double residual = 0.0, square = 0.0, absolute = 0.0;  // about the original's plane
    double column = 0.0, row = 0.0;                       // residual times centred column, row
    double n = 0.0, c = 0.0, r = 0.0, cc = 0.0, cr = 0.0, rr = 0.0;
    double change_square = 0.0, change_max = 0.0;
    std::int64_t both = 0, same = 0;
  };
  using TileCounts = std::array<std::uint16_t, ChangeHistogram::kClasses>;
  LiveDeviation() = default;
  void measure(const FieldReader& now, std::int32_t tc, std::int32_t tr, TileSums& sums) const;
  void count(const FieldReader& now, std::int32_t tc, std::int32_t tr, double reach,
             TileCounts& counts) const;
  [[nodiscard]] std::size_t index(std::int32_t tc, std::int32_t tr) const noexcept;
  void fold(LiveFigures& figures) const;

  Version original_, last_;
  double centre_column_ = 0.0, centre_row_ = 0.0;
  double level_ = 0.0, slope_column_ = 0.0, slope_row_ = 0.0;  // the original's plane
  double sq_original_ = 0.0, sa_original_ = 0.0;
  double reach_ = 0.0;
  std::vector<TileSums> sums_;
  std::vector<TileCounts> counts_;
};

}  // namespace fettle::engine
