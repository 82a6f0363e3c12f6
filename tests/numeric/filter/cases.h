#pragma once

#include <string>
#include <vector>

#include "engine/filter/filter.h"
#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {

/// One filter as the suite walks it: a new kind joins every property with one line in filterCases().
struct FilterCase {
  std::string name;
  FilterSpec spec;
  /// A mean with weights that depend on the distance alone: planes and sums are kept away from borders.
  bool mean = false;
  /// What a result may be off the exact one before it is rounded to float, in 2^-51 of the largest magnitude
  /// in its window: the kind's own statement in filter.h. 0: nothing.
  double error = 0.0;
  /// Every window's sum is taken in an order that mirrors and turns do not change, or has no order: so they
  /// commute with the filter exactly. Otherwise to twice its error.
  bool symmetric = true;

  /// `error` as a height, for a window of that largest magnitude.
  [[nodiscard]] long double errorOf(long double magnitude) const;
  [[nodiscard]] int reach() const { return spec.window / 2; }
};

[[nodiscard]] std::vector<FilterCase> filterCases();

/// Lowest and highest height of each sample's window, and the largest magnitude; holes left out.
struct WindowExtremes {
  std::vector<float> low, high;
  [[nodiscard]] float magnitude(std::size_t i) const;
};
[[nodiscard]] WindowExtremes windowExtremes(const PlainField& field, int window);

/// Whether every sample of the window lies in the field and is no hole: what a mean keeps sums and planes by.
[[nodiscard]] std::vector<std::uint8_t> wholeWindows(const PlainField& field, int window);

/// applyFilter with an original of its own, expecting success.
[[nodiscard]] Filtered filteredFrom(const Version& input, const Version& original, const FilterSpec& spec);

}  // namespace fettle::engine::tests
