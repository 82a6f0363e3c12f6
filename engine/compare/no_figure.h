#pragma once

#include <limits>

namespace fettle::engine {

/// A figure without any sample: NaN here, "-" in a table, null in JSON.
inline constexpr double kNoFigure = std::numeric_limits<double>::quiet_NaN();

}  // namespace fettle::engine
