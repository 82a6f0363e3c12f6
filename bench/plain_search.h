#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/field/version.h"
#include "haptic/contact/surface.h"

namespace fettle::bench {

/// What the tick is held against: the source's own search on nothing but an array of heights. No tiles, no
/// marks, no edits, no effects, no counters, no bound on a search, no guard against bad input or holes.
///
/// In contact it goes from the last proxy's cell to the nearest of the bounded closest points of the cells
/// that share the present one, until none is nearer; free, it starts under the endpoint as soon as that is
/// below the surface. Source: Potter, Johnson, Cohen, DETC2004-57539. Threading: one thread.
class PlainSearch {
 public:
  /// Of a field without holes and of at least 2 x 2 samples.
  explicit PlainSearch(const engine::Version& field);

  /// As before the first tick.
  void reset() noexcept { touching_ = false; }

  /// Force of a spring of `stiffness` [N/mm] on the endpoint; zero when free or beside the field.
  [[nodiscard]] glm::dvec3 tick(const glm::dvec3& endpoint_mm, double stiffness) noexcept;

 private:
  [[nodiscard]] haptic::Patch patch(haptic::CellIndex cell) const noexcept;

  std::vector<float> heights_;  // row-major
  std::int32_t width_, height_;
  double sx_, sy_, unit_;
  bool touching_ = false;
  haptic::CellIndex cell_;
  double u_ = 0.0, v_ = 0.0;
};

}  // namespace fettle::bench
