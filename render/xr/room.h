#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

namespace fettle::render {

/// A place in the room in which a person with a headset is, right-handed: x to the right, y up, z to the back, in metres;
/// the origin on the floor where the runtime knows it, else at the head's first place (Headset::floor).
struct RoomPose {
  glm::dvec3 position_m{0.0};
  glm::dquat turn{1.0, 0.0, 0.0, 0.0};  ///< from the thing's own axes to the room's
};

/// An eye, with tangents of what its picture shows as EyeView has them.
struct RoomEye {
  RoomPose pose;
  double left = -1.0, right = 1.0, down = -1.0, up = 1.0;
};

/// A hand with a controller or a stylus.
struct RoomHand {
  bool tracked = false;  ///< seen where it is now; one that is only guessed at is not
  RoomPose grip;         ///< in the palm
  RoomPose aim;          ///< points along its -z; its origin is the tip
  double trigger = 0.0;  ///< 0 .. 1
  double squeeze = 0.0;  ///< 0 .. 1
  bool button = false;   ///< A or X; the menu button of a simple controller
  double scroll = 0.0;  ///< -1 .. 1, away from oneself positive: the thumbstick; a simple controller has none
};
using RoomHands = std::array<RoomHand, 2>;  ///< left, right

/// The pictures that a headset shows besides the eyes', each with content of its own (Headset::setPicture).
enum class RoomPicture : std::uint8_t { kWindow, kRay, kSpot };
inline constexpr std::size_t kRoomPictures = 3;

/// A rectangle in the room that shows one of them. The runtime draws it over the eyes' pictures, at its own resolution,
/// whatever lies in front of it there.
struct RoomPanel {
  RoomPicture picture = RoomPicture::kWindow;
  RoomPose pose;  ///< of its middle; it faces its +z
  double width_m = 1.0, height_m = 1.0;
};

}  // namespace fettle::render
