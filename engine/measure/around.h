#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "engine/field/version.h"
#include "engine/measure/region.h"

namespace fettle::engine {

/// The radius of a probe where none is given: five samples of the wider spacing [mm].
[[nodiscard]] inline double usualProbeRadiusMm(const Grid& grid) noexcept {
  return 5.0 * std::max(grid.spacingXMm(), grid.spacingYMm());
}

/// Whether a probe can be there: a finite place, and a radius of fewer than a thousand samples.
[[nodiscard]] inline bool canProbe(const Grid& grid, const glm::dvec2& at, double radius_mm) noexcept {
  return std::isfinite(at.x) && std::isfinite(at.y) && radius_mm > 0.0 &&
         radius_mm * radius_mm / (grid.spacingXMm() * grid.spacingYMm()) < 1e6;
}

/// Calls `take(column, row, height)` for each sample of the region within `radius_mm` of `at` (field coordinates [mm]), row by
/// row; holes are none. Only where canProbe().
template <class Take>
void forEachAround(const FieldReader& reader, const glm::dvec2& at, double radius_mm, Region region,
                   Take&& take) {
  constexpr double kRounding = 1e-9;
  const Grid& grid = reader.grid();
  const glm::dvec2 spacing(grid.spacingXMm(), grid.spacingYMm());
  const auto within = [](double value, std::int32_t side) {
    return static_cast<std::int32_t>(std::clamp(value, 0.0, side - 1.0));
  };
  const glm::dvec2 low = (at - radius_mm) / spacing - kRounding,
                   high = (at + radius_mm) / spacing + kRounding;
  for (std::int32_t r = within(std::ceil(low.y), grid.height); r <= within(std::floor(high.y), grid.height);
       ++r)
    for (std::int32_t c = within(std::ceil(low.x), grid.width); c <= within(std::floor(high.x), grid.width);
         ++c) {
      const double z = reader.heightAt(c, r);
      if (glm::length((glm::dvec2(c, r) * spacing - at) / radius_mm) > 1.0 + kRounding || std::isnan(z) ||
          (region != Region::kAll && reader.markedAt(c, r) != (region == Region::kMarked)))
        continue;
      take(c, r, z);
    }
}

}  // namespace fettle::engine
