#pragma once

#include <cstdint>

namespace fettle::engine::planes {

/// Of the windows that planes are fitted in [samples], ascending.
inline constexpr int kHalfWidths[] = {1, 2, 3, 5};

/// Side of the squares that are worked out as a whole, and the samples around each: windows that cover a sample reach
/// twice the largest half-width from it. [samples]
inline constexpr std::int32_t kSide = 256, kHalo = 10;

}  // namespace fettle::engine::planes
