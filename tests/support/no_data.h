#pragma once

#include <limits>

namespace fettle {

/// A sample that is not there, and one that no importer lets through.
inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInf = std::numeric_limits<float>::infinity();

}  // namespace fettle
