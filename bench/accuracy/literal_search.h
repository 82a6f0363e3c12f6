#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "engine/field/version.h"
#include "haptic/base/tick_counters.h"
#include "haptic/contact/contact.h"
#include "haptic/contact/surface.h"

namespace fettle::bench {

/// A point of the surface by cell and parameters.
struct LiteralPoint {
  haptic::CellIndex cell;
  double u = 0.0, v = 0.0;
  glm::dvec3 position_mm{0.0};
  double distance2_mm2 = 0.0;
  bool ringed = false;  ///< every cell that shares it exists
};

/// The source's search as its text has it, in plain double precision on a plain array, without any shortcut: the bounded
/// closest point of the cell, then of all cells that share its edge or vertex; the shortest distance is kept. The
/// reference of level paper (haptic/contact/closest_point.h), thirty times slower: a bounded closest point is looked for
/// at 65 places along each parameter, where the other has its minimum in closed form, and refined. Of distances equal
/// within rounding the first is kept.
///
/// Source: Potter, Johnson, Cohen, DETC2004-57539, "Haptic Rendering". Threading: one thread.
class LiteralSearch {
 public:
  explicit LiteralSearch(const engine::Version& field);

  /// False: a corner of the cell is a hole, or there is no such cell.
  [[nodiscard]] bool bounded(haptic::CellIndex cell, const glm::dvec3& endpoint, LiteralPoint& out) const;
  /// The local closest point of a search from `start`, a cell without holes.
  [[nodiscard]] LiteralPoint from(haptic::CellIndex start, const glm::dvec3& endpoint) const;

 private:
  [[nodiscard]] double height(std::int32_t column, std::int32_t row) const {
    return heights_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                    static_cast<std::size_t>(column)];
  }

  std::vector<double> heights_;  // row-major [mm], NaN: hole
  std::int32_t width_, height_;
  double sx_, sy_;
};

/// Ticks with that search: contact as ContactTracker has it, whose haptic ray and contact test these use. The field does
/// not change.
class LiteralTracker {
 public:
  explicit LiteralTracker(const engine::Version& field);
  /// False: free.
  [[nodiscard]] bool update(const glm::dvec3& endpoint, LiteralPoint& out);

 private:
  [[nodiscard]] bool begins(const glm::dvec3& endpoint, bool below, haptic::CellIndex own, LiteralPoint& out);
  [[nodiscard]] bool touches(const LiteralPoint& point, const glm::dvec3& endpoint);

  engine::Version field_;
  haptic::Surface surface_;
  LiteralSearch search_;
  haptic::TickCounters counters_;
  bool touching_ = false;
  bool has_previous_ = false;
  haptic::CellIndex cell_;
  glm::dvec3 previous_{0.0};
};

}  // namespace fettle::bench
