#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "render/xr/room.h"

namespace fettle::app {

/// Where a ray meets a screen: 0 .. 1 from its left upper corner to its right lower one, while it is on it.
struct ScreenPoint {
  double x = 0.0, y = 0.0;
  glm::dvec3 at_m{0.0};
};

/// The window's frame as a screen that hangs in the room: upright, behind the table, until a hand carries it elsewhere.
class RoomScreen {
 public:
  /// Before this head.
  void place(const render::RoomPose& head);
  [[nodiscard]] bool placed() const noexcept { return placed_; }
  /// Of the frame that it shows. Its width stays.
  void setShape(int width_px, int height_px) noexcept;

  /// Where a ray along -z of `aim` meets its front; nothing where it does not.
  [[nodiscard]] std::optional<ScreenPoint> under(const render::RoomPose& aim) const noexcept;
  /// The same of the plane in which it lies: for a hand that drags something over its rim.
  [[nodiscard]] std::optional<ScreenPoint> beside(const render::RoomPose& aim) const noexcept;
  /// Moves as if it were fixed to a hand.
  void carry(const render::RoomPose& before, const render::RoomPose& now) noexcept;

  [[nodiscard]] render::RoomPanel panel() const noexcept;
  /// A ray from `from` to `to`, as seen by a head; and its end on the screen.
  [[nodiscard]] static render::RoomPanel ray(const glm::dvec3& from, const glm::dvec3& to,
                                             const glm::dvec3& head) noexcept;
  [[nodiscard]] render::RoomPanel spot(const glm::dvec3& at) const noexcept;

 private:
  bool placed_ = false;
  render::RoomPose pose_;
  double width_m_ = 1.1, height_m_ = 0.7;
};

}  // namespace fettle::app
