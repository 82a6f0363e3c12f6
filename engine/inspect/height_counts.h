#pragma once

#include "engine/field/version.h"

namespace fettle::engine {

/// The counts of a sensor: heights that are all `first` plus a whole number of steps.
struct HeightCounts {
  double step = 0.0;   ///< [height_unit]; 0: heights are no counts, or their rounding in float hides them
  double first = 0.0;  ///< a height of the field

  /// The nearest count; the height itself without counts.
  [[nodiscard]] double nearest(double height) const noexcept;
};

/// Finds the counts of a field in 128 x 128 samples, evenly spread over it: the smallest difference between two of
/// them, if all the others are whole multiples of it but for one of a thousand. Where two neighbouring counts are not
/// among them none are found. Throws std::bad_alloc. Any thread; some milliseconds for any size of field.
[[nodiscard]] HeightCounts findHeightCounts(const Version& field);

}  // namespace fettle::engine
