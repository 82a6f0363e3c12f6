#include "app/xr/room_table.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

namespace fettle::app {
namespace {

// A block of 300 x 200 x 10 mm about the origin of its scene.
render::Framing block(double factor = 1.0) {
  render::Framing framing;
  framing.shown =
      framing.drawn = {factor * glm::dvec3(-150.0, -100.0, -5.0), factor * glm::dvec3(150.0, 100.0, 5.0)};
  return framing;
}
render::RoomPose headAt(const glm::dvec3& place) {
  return {place, glm::dquat(1.0, 0.0, 0.0, 0.0)};
}
render::RoomHands hands(const std::optional<glm::dvec3>& left, const std::optional<glm::dvec3>& right) {
  render::RoomHands both;
  for (std::size_t i = 0; i < 2; ++i)
    if (const auto& at = i == 0 ? left : right) {
      both[i].tracked = true;
      both[i].grip.position_m = *at;
      both[i].squeeze = 1.0;
    }
  return both;
}
void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-12) {
  EXPECT_LT(glm::length(a - b), tolerance) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST(RoomTable, a_giant_has_the_field_on_a_table_before_the_head) {
  RoomTable table(RoomScale::kGiant);
  table.place(block(), headAt({1.0, 1.6, 2.0}), true);
  EXPECT_NEAR(table.metresPerMm(), 0.002, 1e-12);
  expectNear(table.roomOf({0.0, 0.0, -5.0}), {1.0, 0.75, 2.0 - 0.55});
  // Its far side lies ahead, its right to the right, its top up.
  expectNear(table.roomOf({150.0, 100.0, 5.0}), {1.3, 0.77, 2.0 - 0.55 - 0.2});
  expectNear(table.sceneOf(table.roomOf({12.0, -7.0, 3.0})), {12.0, -7.0, 3.0}, 1e-9);
}

TEST(RoomTable, it_faces_a_head_that_looks_elsewhere) {
  RoomTable table(RoomScale::kGiant);
  render::RoomPose head = headAt({0.0, 1.6, 0.0});
  head.turn =
      glm::dquat(std::cos(0.25 * std::numbers::pi), 0.0, std::sin(0.25 * std::numbers::pi), 0.0);  // to -x
  table.place(block(), head, true);
  expectNear(table.roomOf({0.0, 0.0, -5.0}), {-0.55, 0.75, 0.0});
  expectNear(table.directionInScene({-1.0, 0.0, 0.0}), {0.0, 1.0, 0.0});
}

TEST(RoomTable, true_size_is_a_millimetre_a_millimetre_and_large_fields_are_stood_on) {
  RoomTable table(RoomScale::kTrue);
  table.place(block(), headAt({0.0, 1.6, 0.0}), true);
  EXPECT_EQ(table.metresPerMm(), 1e-3);
  expectNear(table.roomOf({0.0, 0.0, -5.0}), {0.0, 0.75, -0.55});
  table.place(block(100.0), headAt({0.0, 1.6, 0.0}), true);
  expectNear(table.roomOf({0.0, 0.0, 0.0}), {0.0, 0.0, 0.0});
}

TEST(RoomTable, one_hand_moves_the_field_with_it) {
  RoomTable table(RoomScale::kGiant);
  table.place(block(), headAt({0.0, 1.6, 0.0}), true);
  const glm::dvec3 held = table.sceneOf({0.2, 0.8, -0.5});
  table.follow(hands({}, glm::dvec3(0.2, 0.8, -0.5)));
  expectNear(table.roomOf(held), {0.2, 0.8, -0.5});
  table.follow(hands({}, glm::dvec3(0.3, 0.9, -0.7)));
  expectNear(table.roomOf(held), {0.3, 0.9, -0.7});
  table.follow(hands({}, {}));
  table.follow(hands({}, glm::dvec3(0.0, 0.0, 0.0)));  // takes hold again
  expectNear(table.roomOf(held), {0.3, 0.9, -0.7});
}

TEST(RoomTable, two_hands_scale_and_turn_what_they_hold) {
  RoomTable table(RoomScale::kGiant);
  table.place(block(), headAt({0.0, 1.6, 0.0}), true);
  const glm::dvec3 left{-0.1, 0.8, -0.5}, right{0.1, 0.8, -0.5};
  const glm::dvec3 held_left = table.sceneOf(left), held_right = table.sceneOf(right);
  table.follow(hands(left, right));
  // Three times as far apart, turned by 90 degrees, moved.
  const glm::dvec3 to_left{0.2, 0.9, -0.2}, to_right{0.2, 0.9, -0.8};
  table.follow(hands(to_left, to_right));
  EXPECT_NEAR(table.metresPerMm(), 0.006, 1e-12);
  expectNear(table.roomOf(held_left), to_left);
  expectNear(table.roomOf(held_right), to_right);
}

TEST(RoomTable, a_button_changes_between_giant_and_true_once) {
  RoomTable table(RoomScale::kGiant);
  table.place(block(), headAt({0.0, 1.6, 0.0}), true);
  render::RoomHands pressed;
  pressed[1].button = true;
  table.follow(pressed);
  table.follow(pressed);
  EXPECT_EQ(table.scale(), RoomScale::kTrue);
  EXPECT_EQ(table.metresPerMm(), 1e-3);
  table.follow({});
  table.follow(pressed);
  EXPECT_EQ(table.scale(), RoomScale::kGiant);
}

}  // namespace
}  // namespace fettle::app
