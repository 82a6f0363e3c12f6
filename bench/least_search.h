#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "bench/plain_heights.h"
#include "engine/field/version.h"
#include "haptic/base/strokes.h"
#include "haptic/contact/surface.h"

namespace fettle::bench {

/// What a tick of level paper cannot do without, and nothing else: the lower bound of its time. Which cells a search goes
/// through, and where their bounded closest points lie, is known beforehand; it remains to compute these points, one
/// per cell, from a plain array: of the four edges where the point lies on one (two packed divisions), else by Newton's
/// method from the last point; and to show at the end that no cell around is nearer, from their corners.
///
/// No choice of a method, no test of what a cell contains, no cell that turns out farther, no tiles, effects, counters.
/// Threading: one thread.
class LeastSearch {
 public:
  /// Of a field without holes and of at least 2 x 2 samples, and the contacts of these strokes on it at level paper.
  LeastSearch(const engine::Version& field, std::span<const haptic::StrokeSample> strokes);

  /// Computes all bounded closest points; the sum of the heights of the last of each tick, so that nothing is left out.
  [[nodiscard]] double run() const noexcept;

  /// Averages of a contact.
  [[nodiscard]] double cells() const noexcept { return perContact(steps_.size()); }
  [[nodiscard]] double newtonCells() const noexcept { return perContact(newton_cells_); }
  /// Read from the array, shared corners counted once per cell [bytes].
  [[nodiscard]] double bytes() const noexcept { return sizeof(float) * perContact(samples_); }
  [[nodiscard]] std::int64_t contacts() const noexcept { return contacts_; }

 private:
  struct Step {
    glm::dvec3 endpoint_mm;
    std::int32_t column, row;
    double u, v;         // where Newton's method begins
    bool newton;         // the point lies inside the cell
    bool last;           // of its tick
    std::int8_t du, dv;  // the cells around the last point: -1, 0 or 1 along each parameter
  };
  [[nodiscard]] double perContact(std::size_t count) const noexcept {
    return contacts_ > 0 ? static_cast<double>(count) / static_cast<double>(contacts_) : 0.0;
  }

  PlainHeights heights_;
  std::vector<Step> steps_;
  std::size_t newton_cells_ = 0, samples_ = 0;
  std::int64_t contacts_ = 0;
};

}  // namespace fettle::bench
