#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/field/grid.h"
#include "engine/marks/polygon.h"

namespace fettle::app {

/// A line being drawn over the picture, to mark what is inside. By mouse: hold and draw, or click corner
/// after corner. By keys: a cross moves with the arrows, Space sets a corner, Enter closes. Pixels are those
/// of the window's frame. Threading: main.
class Lasso {
 public:
  enum class Shape : std::uint8_t { kFree, kBox };
  /// Where a place of the picture lies in the field's plane [mm]; empty where it lies nowhere.
  using Locate = std::function<std::optional<glm::dvec2>(const glm::dvec2& pixel)>;

  void begin(Shape shape, const glm::dvec2& cross);
  void leave() { active_ = false; }
  [[nodiscard]] bool active() const noexcept { return active_; }
  [[nodiscard]] Shape shape() const noexcept { return shape_; }

  /// Sets a corner where the cross is. True when that closes it: a box's second corner.
  bool set();
  /// The cross is here now; `drawing`: the button is held, and the line follows.
  enum class Drawing : std::uint8_t { kNo, kYes };
  void move(const glm::dvec2& cross, Drawing drawing);
  /// Takes the last corner back; false when there is none.
  bool takeBack();

  [[nodiscard]] const glm::dvec2& cross() const noexcept { return cross_; }
  /// The line as it would be closed now, in pixels.
  [[nodiscard]] std::vector<glm::dvec2> line() const;
  /// Whether it has room inside: a click alone has not.
  [[nodiscard]] bool closes() const;
  /// The line in the field's samples, ends it. Its straight pieces are followed over the surface in pieces of
  /// 8 pixels; places that lie nowhere are left out.
  [[nodiscard]] engine::Polygon finish(const engine::Grid& grid, const Locate& locate);

 private:
  bool active_ = false;
  Shape shape_ = Shape::kFree;
  glm::dvec2 cross_{0.0};
  std::vector<glm::dvec2> corners_;
};

}  // namespace fettle::app
