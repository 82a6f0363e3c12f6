#pragma once

#include <cstdint>
#include <span>

#include "engine/field/version.h"

namespace fettle::bench {

/// A field made to be hard for a search of the closest point.
struct HardGround {
  const char* name;
  /// Height of sample (column, row) [mm].
  float (*height)(std::int32_t column, std::int32_t row) noexcept;
};

/// Needles 1e6 mm high, cells twisted as far as 10 of their sides, walls of 200 of their sides that stand
/// eight apart, and pits whose slopes turn from 1 to 1000.
[[nodiscard]] std::span<const HardGround> hardGrounds() noexcept;

[[nodiscard]] engine::Version makeGround(const HardGround& ground, std::int32_t side, double spacing_mm);

}  // namespace fettle::bench
