#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "engine/field/version.h"

namespace fettle::engine {

/// What can be shown of a result before all of it is there.
struct EarlyPicture {
  /// How far the approximation is off [height_unit].
  struct Off {
    double rms = 0.0;
    bool estimated = false;  ///< against a coarser approximation, not against results
  };

  Version field;           ///< of the grid of the input, or of one with `step` times its spacing
  std::int32_t step = 1;   ///< samples on a side of the means that it is of; 1: of samples
  double exact = 0.0;      ///< share of what changes in view that has the result's bits, 0 .. 1
  double untouched = 0.0;  ///< and of what shows the input
  std::optional<Off> off;  ///< of an approximation; empty: what has not the result's bits shows the input
};

/// Takes a picture that is to be shown in place of the one before, on the thread that works.
using ShowEarly = std::function<void(EarlyPicture picture)>;

}  // namespace fettle::engine
