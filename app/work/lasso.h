#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/field/grid.h"
#include "engine/marks/polygon.h"

namespace fettle::app {

/// A line drawn over the picture, to mark the samples inside. By mouse: hold and draw, or click corner after
/// corner. By keys: a cross moves with the arrows, Space sets a corner, Enter closes. Pixels are those of the
/// window's frame. Threading: main.
class Lasso {
 public:
  enum class Shape : std::uint8_t { kFree, kBox };
  /// Positions in the field of a point of the picture [mm]; empty where there is none.
  struct Places {
    /// On the surface that is seen there.
    std::function<std::optional<glm::dvec3>(const glm::dvec2& pixel)> on_surface;
    /// On the level plane of that height [mm], or of the middle one.
    std::function<std::optional<glm::dvec2>(const glm::dvec2& pixel, std::optional<double> height)> on_level;
  };

  void begin(Shape shape, const glm::dvec2& cross);
  void leave() { active_ = false; }
  [[nodiscard]] bool active() const noexcept { return active_; }
  [[nodiscard]] Shape shape() const noexcept { return shape_; }

  /// Sets a corner at the cross. True when that closes the line: a box's second corner.
  bool set();
  /// Moves the cross; `drawing`: the button is held, and the line follows.
  enum class Drawing : std::uint8_t { kNo, kYes };
  void move(const glm::dvec2& cross, Drawing drawing);
  /// Removes the last corner; false when there is none.
  bool takeBack();

  [[nodiscard]] const glm::dvec2& cross() const noexcept { return cross_; }
  /// The line as it would be closed at present, in pixels.
  [[nodiscard]] std::vector<glm::dvec2> line() const;
  /// Whether it encloses an area: a single click does not.
  [[nodiscard]] bool closes() const;
  /// Ends the line and returns it in the field's samples. Its straight sides are followed over the surface in
  /// pieces of 8 pixels. Over holes and beside the field it goes on at the height of the surface where it was seen last, along
  /// the line in either direction; points without a position are left out.
  [[nodiscard]] engine::Polygon finish(const engine::Grid& grid, const Places& places);

 private:
  bool active_ = false;
  Shape shape_ = Shape::kFree;
  glm::dvec2 cross_{0.0};
  std::vector<glm::dvec2> corners_;
};

}  // namespace fettle::app
