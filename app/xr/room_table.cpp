#include "app/xr/room_table.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace fettle::app {
namespace {

constexpr double kSide_m = 0.6;        // of a field on the table
constexpr double kAhead_m = 0.55;      // of its middle before the head
constexpr double kTable_m = 0.75;      // over the floor
constexpr double kUnderHead_m = 0.55;  // of the table, where the floor is not known
constexpr double kStandsOn_m = 2.0;    // a field this large at true size is stood on
constexpr double kEyes_m = 1.6;        // over the floor, where it is not known
constexpr double kSqueezes = 0.5;
constexpr double kSmallest = 1e-9, kLargest = 1e3;  // metres for a millimetre

glm::dvec3 turnedAbout(double yaw, const glm::dvec3& room) {
  const double c = std::cos(yaw), s = std::sin(yaw);
  return {c * room.x + s * room.z, room.y, -s * room.x + c * room.z};
}

// The scene has z up, the room y.
glm::dvec3 upright(const glm::dvec3& scene) {
  return {scene.x, scene.z, -scene.y};
}
glm::dvec3 lying(const glm::dvec3& room) {
  return {room.x, -room.z, room.y};
}

}  // namespace

glm::dvec3 RoomTable::roomOf(const glm::dvec3& scene_mm) const noexcept {
  return origin_m_ + turnedAbout(yaw_, metres_per_mm_ * upright(scene_mm));
}

glm::dvec3 RoomTable::directionInScene(const glm::dvec3& in_room) const noexcept {
  return lying(turnedAbout(-yaw_, in_room));
}

glm::dvec3 RoomTable::sceneOf(const glm::dvec3& room_m) const noexcept {
  return directionInScene(room_m - origin_m_) / metres_per_mm_;
}

render::EyeView RoomTable::eyeOf(const render::RoomEye& eye) const noexcept {
  const auto axis = [&](const glm::dvec3& own) { return directionInScene(eye.pose.turn * own); };
  render::EyeView view;
  view.position = sceneOf(eye.pose.position_m);
  view.axes = {axis({1.0, 0.0, 0.0}), axis({0.0, 1.0, 0.0}), axis({0.0, 0.0, 1.0})};
  view.left = eye.left;
  view.right = eye.right;
  view.down = eye.down;
  view.up = eye.up;
  return view;
}

void RoomTable::place(const render::Framing& framing, const render::RoomPose& head, bool on_floor) {
  framing_ = framing;
  head_ = head;
  on_floor_ = on_floor;
  const glm::dvec3 ahead = head.turn * glm::dvec3(0.0, 0.0, -1.0);
  // The side of low y is nearest to one who looks ahead, as on a map.
  yaw_ = std::hypot(ahead.x, ahead.z) > 1e-3 ? std::atan2(-ahead.x, -ahead.z) : 0.0;
  putAt(framing);
  placed_ = true;
}

void RoomTable::putAt(const render::Framing& framing) {
  ++placements_;
  const double side = std::max(framing.longerSide(), 1e-6);
  metres_per_mm_ = scale_ == RoomScale::kTrue ? 1e-3 : kSide_m / side;
  glm::dvec3 below = framing.middle();
  below.z = framing.drawn.low.z;
  const bool stands = scale_ == RoomScale::kTrue && 1e-3 * side > kStandsOn_m;
  if (stands) below.z = framing.middle().z;
  const double floor_m = on_floor_ ? 0.0 : head_.position_m.y - kEyes_m;
  const double table_m = on_floor_ ? kTable_m : head_.position_m.y - kUnderHead_m;
  glm::dvec3 at = head_.position_m + turnedAbout(yaw_, {0.0, 0.0, stands ? 0.0 : -kAhead_m});
  at.y = stands ? floor_m : table_m;
  origin_m_ = glm::dvec3(0.0);
  origin_m_ = at - roomOf(below);
}

void RoomTable::follow(const render::RoomHands& hands) {
  const bool button = std::any_of(hands.begin(), hands.end(), [](const auto& hand) { return hand.button; });
  if (button && !button_ && placed_) {
    scale_ = scale_ == RoomScale::kGiant ? RoomScale::kTrue : RoomScale::kGiant;
    putAt(framing_);
  }
  button_ = button;
  std::array<std::optional<glm::dvec3>, 2> now;
  for (std::size_t i = 0; i < 2; ++i)
    if (hands[i].tracked && hands[i].squeeze > kSqueezes) now[i] = hands[i].grip.position_m;
  // A hand that begins to hold, or lets go, moves nothing in that frame.
  const bool left = now[0] && held_[0], right = now[1] && held_[1];
  if (left && right) {
    const glm::dvec3 before = *held_[1] - *held_[0], after = *now[1] - *now[0];
    const double ratio = glm::length(before) > 1e-3 ? glm::length(after) / glm::length(before) : 1.0;
    // Angles of vertical pairs mean nothing.
    const bool level = std::hypot(before.x, before.z) > 0.02 && std::hypot(after.x, after.z) > 0.02;
    const double turn = level ? std::atan2(-after.z, after.x) - std::atan2(-before.z, before.x) : 0.0;
    const glm::dvec3 from = 0.5 * (*held_[0] + *held_[1]), to = 0.5 * (*now[0] + *now[1]);
    const double scaled = std::clamp(metres_per_mm_ * ratio, kSmallest, kLargest);
    origin_m_ = to + turnedAbout(turn, (scaled / metres_per_mm_) * (origin_m_ - from));
    metres_per_mm_ = scaled;
    yaw_ += turn;
  } else if (left || right) {
    const std::size_t hand = left ? 0 : 1;
    origin_m_ += *now[hand] - *held_[hand];
  }
  held_ = now;
}

}  // namespace fettle::app
