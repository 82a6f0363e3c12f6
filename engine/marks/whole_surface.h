#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/base/job.h"
#include "engine/field/reader.h"
#include "engine/filter/median.h"

namespace fettle::engine {

/// The heights of a block and around it, with a height everywhere, so that derivatives can be taken of it.
///
/// Single outliers are replaced by the median of their 3 x 3 (5 x 5 from sigma 1.5 on) surroundings, by the
/// rule of Hampel (1974), which leaves all others as they are. Holes, and what lies beyond the border, are
/// continued as the plane through what is around them (weighted least squares).
///
/// Threading: one thread at a time; each thread needs its own object.
class WholeSurface {
 public:
  /// For kernels of `sigma` [samples, > 0] that reach `radius` samples.
  WholeSurface(double sigma, int radius);

  /// How far from a sample the heights reach that a hole there is continued from [samples].
  [[nodiscard]] int fillReach() const noexcept { return fill_reach_; }

  /// Reads [column, column + columns) x [row, row + rows), which may reach beyond the field. False when
  /// cancelled. Throws std::bad_alloc.
  [[nodiscard]] bool read(const FieldReader& field, std::int32_t column, std::int32_t row, int columns,
                          int rows, const JobControl& job);

  // Of the last block, columns x rows, row-major.
  std::vector<float> heights;       ///< less the first of them, which would cost precision [height unit]
  std::vector<std::uint8_t> valid;  ///< 1: a sample of the field, 0: continued
  bool holes = false;               ///< whether any is continued

 private:
  void fill(int columns, int rows);

  double sigma_;
  int median_reach_;
  int fill_reach_;
  std::unique_ptr<BlockFilter> median_;
  std::vector<float> raw_, middle_, rest_, spread_;
  std::vector<std::int32_t> counts_;
};

}  // namespace fettle::engine
