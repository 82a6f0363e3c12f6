#pragma once

#include <cstdint>
#include <span>

#include "engine/field/version.h"

namespace fettle::bench {

/// A field that is difficult for a search of the closest point.
struct HardGround {
  const char* name;
  /// Height of sample (column, row) [mm].
  float (*height)(std::int32_t column, std::int32_t row) noexcept;
};

/// Needles 1e6 mm high, cells with a twist of 10 of their sides, walls of 200 sides height eight cells apart,
/// and pits whose slopes change from 1 to 1000.
[[nodiscard]] std::span<const HardGround> hardGrounds() noexcept;

[[nodiscard]] engine::Version makeGround(const HardGround& ground, std::int32_t side, double spacing_mm);

}  // namespace fettle::bench
