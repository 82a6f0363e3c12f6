#pragma once

#include <limits>

namespace fettle::engine {

/// The noise of a scan as the figures of a section count it, standard deviations [mm].
struct SectionNoise {
  /// Of a sample's own noise, independent from sample to sample; NaN where it is not known.
  double sample_mm = std::numeric_limits<double>::quiet_NaN();
  /// Of what a whole row of samples is off, and a whole column.
  double rows_mm = 0.0, columns_mm = 0.0;
};

}  // namespace fettle::engine
