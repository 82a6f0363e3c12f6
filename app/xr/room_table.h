#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <glm/vec3.hpp>

#include "render/plan/framing.h"
#include "render/xr/room.h"

namespace fettle::app {

/// How large the field is in the room at first, and after the button that changes it.
enum class RoomScale : std::uint8_t {
  kGiant,  ///< as a giant sees it: its longer side is 0.6 m, on a table before one
  kTrue,  ///< a millimetre is a millimetre; a field above two metres lies on the floor, with its middle under one
};

/// Where the picture's scene is in the room: scaled, turned about the vertical, moved. One hand that squeezes holds the field
/// and moves it; two also turn it and change its size. A button changes between giant and true.
///
/// Threading: one thread.
class RoomTable {
 public:
  explicit RoomTable(RoomScale scale) noexcept : scale_(scale) {}

  /// Puts a field before the head: where it is shown for the first time, or another follows. `on_floor`: the room's origin is.
  void place(const render::Framing& framing, const render::RoomPose& head, bool on_floor);
  /// Until it is placed again there is none.
  void remove() noexcept { placed_ = false; }
  [[nodiscard]] bool placed() const noexcept { return placed_; }
  /// How often it was put anywhere, by place() and by the button: a hand that rests is elsewhere on it then. Not counted: what hands
  /// that hold it do.
  [[nodiscard]] std::uint64_t placements() const noexcept { return placements_; }
  [[nodiscard]] RoomScale scale() const noexcept { return scale_; }
  /// Metres of the room for a millimetre of the scene.
  [[nodiscard]] double metresPerMm() const noexcept { return metres_per_mm_; }

  /// The hands of a frame: moves the field with what they hold.
  void follow(const render::RoomHands& hands);

  [[nodiscard]] glm::dvec3 sceneOf(const glm::dvec3& room_m) const noexcept;
  [[nodiscard]] glm::dvec3 roomOf(const glm::dvec3& scene_mm) const noexcept;
  /// A direction; its length stays.
  [[nodiscard]] glm::dvec3 directionInScene(const glm::dvec3& in_room) const noexcept;
  [[nodiscard]] render::EyeView eyeOf(const render::RoomEye& eye) const noexcept;

 private:
  void putAt(const render::Framing& framing);

  RoomScale scale_;
  bool placed_ = false;
  std::uint64_t placements_ = 0;
  render::Framing framing_;  // of the field placed
  render::RoomPose head_;    // when it was placed
  bool on_floor_ = false;
  double metres_per_mm_ = 1e-3;
  double yaw_ = 0.0;          // of the scene in the room, counter-clockwise from above [rad]
  glm::dvec3 origin_m_{0.0};  // of the scene in the room
  std::array<std::optional<glm::dvec3>, 2> held_;  // places of the hands that squeezed in the last frame
  bool button_ = false;
};

}  // namespace fettle::app
