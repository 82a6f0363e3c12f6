#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/field/grid.h"

namespace fettle::engine {

/// Evenly spaced positions along one axis: origin + k * spacing, 0 <= k < count.
struct AxisLattice {
  double origin = 0.0;
  double spacing = 0.0;  ///< 0 when all values are equal
  std::int64_t count = 0;
  bool one_value_each = true;  ///< no position has two different values
  std::int64_t taken = 0;      ///< positions with a value, where the lattice was detected

  /// Index of the position nearest to a value within the lattice.
  [[nodiscard]] std::int64_t indexOf(double value) const noexcept;
};

/// Size, spacing and origin of a grid whose samples lie on these positions.
void placeOn(const AxisLattice& x, const AxisLattice& y, Grid& grid) noexcept;

/// Finds the evenly spaced positions of `values` (finite, any order, repetitions allowed, at least one),
/// where positions may be missing. Each value may differ from its position by a tenth of the spacing - files
/// round to few digits - and at least a quarter of the positions must be taken, or half of the differences
/// between neighbouring values be one step, at any distance of the others; otherwise nothing.
///
/// Spacing and origin are fitted by least squares to all distinct values, then rounded to the fewest decimal
/// digits within three standard errors of the fit (and, for values that are floats, half an ulp of a float):
/// 0.024 written with three digits gives 0.024.
///
/// O(n) for a lattice; at most 2^20 distinct values are read, more are not a lattice that a field can hold.
[[nodiscard]] std::optional<AxisLattice> findAxisLattice(const std::vector<double>& values);

/// The same, and after the widest lattice that fits, narrower ones: patches of points at large distances also
/// fit a lattice of one position per patch.
class AxisLatticeSearch {
 public:
  explicit AxisLatticeSearch(const std::vector<double>& values);
  /// The next narrower lattice that fits with more taken positions; nothing after the last.
  [[nodiscard]] std::optional<AxisLattice> next();

 private:
  std::vector<double> values_;   // distinct, ascending; empty: no lattice
  std::vector<double> gaps_;     // ascending
  std::vector<double> guesses_;  // of the spacing, widest first
  std::size_t at_ = 0;
  std::int64_t last_taken_ = 0;
};

}  // namespace fettle::engine
