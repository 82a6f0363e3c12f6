#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "bench/plain_heights.h"
#include "engine/field/version.h"
#include "haptic/contact/surface.h"

namespace fettle::bench {

/// The yardstick of a tick: the source's own search on a plain array of heights. No tiles, marks, edits,
/// effects, counters, bound of the search, or checks for bad input or holes.
///
/// In contact it moves from the last proxy's cell to the nearest of the bounded closest points of the cells
/// that share the present one, until none is nearer; free, it starts below the endpoint as soon as that is
/// below the surface. Source: Potter, Johnson, Cohen, DETC2004-57539. Threading: one thread.
class PlainSearch {
 public:
  /// Of a field without holes and of at least 2 x 2 samples.
  explicit PlainSearch(const engine::Version& field);

  /// As before the first tick.
  void reset() noexcept { touching_ = false; }

  /// Force of a spring of `stiffness` [N/mm] on the endpoint; zero when free or outside the field.
  [[nodiscard]] glm::dvec3 tick(const glm::dvec3& endpoint_mm, double stiffness) noexcept;

 private:
  PlainHeights heights_;
  bool touching_ = false;
  haptic::CellIndex cell_;
  double u_ = 0.0, v_ = 0.0;
};

}  // namespace fettle::bench
