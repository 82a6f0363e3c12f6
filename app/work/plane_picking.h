#pragma once

#include <optional>
#include <span>

#include <glm/vec2.hpp>

#include "engine/field/grid.h"
#include "engine/measure/form_fit.h"

namespace fettle::app {

/// Three points of a plane in a choice of form, until somebody sets them: a triangle that spans most of the field.
void choosePlaneByPoints(engine::FormChoice& choice, const engine::Grid& grid);

/// The three points of a plane while a person sets them on the surface, one after the other. Threading: main.
class PlanePicking {
 public:
  /// The first point is expected, of a plane through three points whatever `choice` was.
  void begin(engine::FormChoice& choice, const engine::Grid& grid);
  /// The next point; true with the third, and none is expected any more. Only where one is.
  [[nodiscard]] bool take(const glm::dvec2& at_mm, engine::FormChoice& choice);
  /// None is expected any more, and the choice is that of before begin().
  void leave(engine::FormChoice& choice);
  /// The same with the choice as it is.
  void stop() noexcept { next_.reset(); }

  /// The point that is expected, 0 .. 2; nothing: none.
  [[nodiscard]] const std::optional<std::size_t>& next() const noexcept { return next_; }
  /// Of a choice: those set so far, all while none is expected [mm in field coordinates].
  [[nodiscard]] std::span<const glm::dvec2> set(const engine::FormChoice& choice) const noexcept;

 private:
  std::optional<std::size_t> next_;
  engine::FormChoice before_;
};

}  // namespace fettle::app
