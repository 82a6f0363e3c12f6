#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/field/grid.h"
#include "engine/field/version.h"
#include "haptic/base/tools.h"
#include "haptic/loop/messages.h"

namespace fettle::app {

/// Paths of the tip, each without a gap as over a hole, in their order; points in the tip's order [samples], multiples of 2^-20, a
/// quarter of a sample apart at least.
using StrokePieces = std::vector<std::vector<glm::dvec2>>;

/// A stroke of a tool that edits marks.
struct MarkStroke {
  haptic::Tool tool = haptic::Tool::kMark;
  StrokePieces pieces;            ///< one at least, none of them empty
  engine::Version before, after;  ///< upright; the field before the stroke and at its end
};

/// Keeps the path of the tip while a tool that edits marks touches the surface, from the ticks of a live loop.
/// Threading: main.
class StrokePath {
 public:
  struct Ended {
    haptic::Tool tool = haptic::Tool::kMark;
    StrokePieces pieces;
  };

  /// Keeps nothing.
  StrokePath() = default;
  explicit StrokePath(const engine::Grid& grid) : spacing_mm_(grid.spacingXMm(), grid.spacingYMm()) {}

  /// The ticks in their order; `tick` counts from 0.
  void add(std::uint64_t tick, const haptic::TickRecord& record);
  /// A stroke has ended with the ticks before `tick`: the paths until there, those of one tool together until another was in
  /// use.
  [[nodiscard]] std::vector<Ended> endAt(std::uint64_t tick);
  /// The ticks before `tick` belong to no stroke any more.
  void dropBefore(std::uint64_t tick);
  [[nodiscard]] bool empty() const noexcept { return points_.empty(); }

 private:
  struct Point {
    std::uint64_t tick = 0;
    bool begins = false;  // contact was lost before it, or the tool was another
    haptic::Tool tool = haptic::Tool::kMark;
    glm::dvec2 at{0.0};
  };
  glm::dvec2 spacing_mm_{0.0};
  std::deque<Point> points_;
  bool interrupted_ = true;
};

}  // namespace fettle::app
