#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace fettle::engine {

/// Evenly spaced positions along one axis: origin + k * spacing, 0 <= k < count.
struct AxisLattice {
  double origin = 0.0;
  double spacing = 0.0;  ///< 0 when all values are one
  std::int64_t count = 0;
  bool one_value_each = true;  ///< no position is hit by two different values
  std::int64_t taken = 0;      ///< positions that a value lies on, where the lattice was found

  /// Index of the position nearest to a value within the lattice.
  [[nodiscard]] std::int64_t indexOf(double value) const noexcept;
};

/// Finds the positions that `values` (finite, any order, any number of times each, at least one) lie on,
/// missing ones allowed. Each value may be off its position by a tenth of the spacing - files round to few
/// digits - and at least a quarter of the positions must be taken, or half of the differences between
/// neighbouring values be one step, however far apart what else there is lies; else nothing.
///
/// Spacing and origin are fitted by least squares to all distinct values, then rounded to the fewest decimal
/// digits within three standard errors of the fit (and, for values that are floats, half an ulp of a float):
/// 0.024 written with three digits comes out as 0.024.
///
/// O(n) for a lattice; at most 2^20 distinct values are looked at, more are no lattice that a field can hold.
[[nodiscard]] std::optional<AxisLattice> findAxisLattice(const std::vector<double>& values);

/// The same, and after the widest lattice that fits narrower ones: patches of points that lie far apart fit a
/// lattice of one position a patch as well.
class AxisLatticeSearch {
 public:
  explicit AxisLatticeSearch(const std::vector<double>& values);
  /// The next narrower lattice that fits and of which more positions are taken; nothing after the last.
  [[nodiscard]] std::optional<AxisLattice> next();

 private:
  std::vector<double> values_;   // distinct, ascending; empty: no lattice
  std::vector<double> gaps_;     // ascending
  std::vector<double> guesses_;  // of the spacing, widest first
  std::size_t at_ = 0;
  std::int64_t last_taken_ = 0;
};

}  // namespace fettle::engine
