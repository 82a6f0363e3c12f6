// Hands that point at the window's frame in the room, carry it, or are the tip.
#include "app/xr/room_hands.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

namespace fettle::app {
namespace {

using Kind = ScreenInput::Kind;

// A screen 1.15 m ahead of a head at 1.6 m: 1.1 m x 0.55 m about (0, 1.5, -1.15).
struct RoomHandUsesTest : ::testing::Test {
  RoomScreen screen;
  RoomHandUses uses;
  render::RoomHands hands;

  void SetUp() override {
    screen.setShape(1000, 500);
    screen.place({{0.0, 1.6, 0.0}, glm::dquat(1.0, 0.0, 0.0, 0.0)});
  }
  // A hand that looks straight ahead, at the screen's place x, y [m from its middle]; far away, it sees none of it.
  void at(std::size_t i, double x, double y) {
    hands[i].tracked = true;
    hands[i].aim = hands[i].grip = {{x, 1.5 + y, -0.5}, glm::dquat(1.0, 0.0, 0.0, 0.0)};
  }
  std::vector<ScreenInput> follow() {
    uses.follow(hands, 0.01, screen);
    return uses.input();
  }
  static constexpr double kAway = 3.0;
};

TEST_F(RoomHandUsesTest, a_ray_gives_the_cursor) {
  at(1, 0.0, 0.0);
  auto input = follow();
  ASSERT_EQ(input.size(), 1U);
  EXPECT_EQ(input[0].kind, Kind::kMove);
  EXPECT_NEAR(input[0].x, 0.5, 1e-9);
  EXPECT_NEAR(input[0].y, 0.5, 1e-9);
  EXPECT_NEAR(glm::length(uses.pointing()->point.at_m - glm::dvec3(0.0, 1.5, -1.15)), 0.0, 1e-9);
  EXPECT_TRUE(follow().empty()) << "it did not move";
  at(1, 0.275, 0.1375);
  input = follow();
  ASSERT_EQ(input.size(), 1U);
  EXPECT_NEAR(input[0].x, 0.75, 1e-9);
  EXPECT_NEAR(input[0].y, 0.25, 1e-9);
  at(1, kAway, 0.0);
  input = follow();
  ASSERT_EQ(input.size(), 1U);
  EXPECT_EQ(input[0].kind, Kind::kLeave);
  EXPECT_FALSE(uses.pointing());
}

TEST_F(RoomHandUsesTest, a_trigger_clicks_where_the_ray_is_and_is_no_tip) {
  at(1, 0.1, 0.0);
  (void)follow();
  hands[1].trigger = 0.9;
  auto input = follow();
  ASSERT_EQ(input.size(), 1U);
  EXPECT_EQ(input[0].kind, Kind::kDown);
  EXPECT_FALSE(uses.tip());
  hands[1].trigger = 0.4;
  EXPECT_TRUE(follow().empty()) << "not released yet";
  hands[1].trigger = 0.1;
  input = follow();
  ASSERT_EQ(input.size(), 1U);
  EXPECT_EQ(input[0].kind, Kind::kUp);
  EXPECT_FALSE(uses.tip());
}

TEST_F(RoomHandUsesTest, what_is_dragged_over_the_rim_stays_held) {
  at(1, 0.5, 0.0);
  (void)follow();
  hands[1].trigger = 1.0;
  (void)follow();
  at(1, kAway, 0.0);
  hands[1].trigger = 1.0;
  auto input = follow();
  ASSERT_EQ(input.size(), 1U);
  EXPECT_EQ(input[0].kind, Kind::kMove);
  EXPECT_EQ(input[0].x, 1.0);
  EXPECT_FALSE(uses.tip());
  hands[1].trigger = 0.0;
  input = follow();
  ASSERT_EQ(input.size(), 1U);
  EXPECT_EQ(input[0].kind, Kind::kUp);
  input = follow();
  ASSERT_EQ(input.size(), 1U);
  EXPECT_EQ(input[0].kind, Kind::kLeave);
}

TEST_F(RoomHandUsesTest, a_trigger_elsewhere_makes_the_hand_the_tip) {
  at(1, kAway, 0.0);
  (void)follow();
  EXPECT_FALSE(uses.tip());
  hands[1].trigger = 1.0;
  (void)follow();
  ASSERT_TRUE(uses.tip());
  EXPECT_EQ(uses.tip()->hand, 1U);
  EXPECT_TRUE(uses.tip()->pressed);
  at(1, 0.0, 0.0);
  hands[1].trigger = 1.0;
  EXPECT_TRUE(follow().empty()) << "a stroke that passes before the screen is no click";
  EXPECT_TRUE(uses.tip()->pressed);
  hands[1].trigger = 0.0;
  (void)follow();
  EXPECT_FALSE(uses.tip()->pressed);
  const auto input = follow();
  ASSERT_EQ(input.size(), 1U);
  EXPECT_EQ(input[0].kind, Kind::kMove);
  EXPECT_FALSE(uses.tip()) << "it points now";
  at(1, kAway, 0.0);
  (void)follow();
  EXPECT_TRUE(uses.tip()) << "it is the tip again";
}

TEST_F(RoomHandUsesTest, the_last_hand_to_press_is_the_tip) {
  at(0, -kAway, 0.0);
  at(1, kAway, 0.0);
  (void)follow();
  hands[1].trigger = 1.0;
  (void)follow();
  hands[1].trigger = 0.0;
  hands[0].trigger = 1.0;
  (void)follow();
  EXPECT_EQ(uses.tip()->hand, 0U);
  hands[0].trigger = 0.0;
  (void)follow();
  hands[0].squeeze = 1.0;
  (void)follow();
  EXPECT_FALSE(uses.tip()) << "it holds the field";
  hands[0].squeeze = 0.0;
  hands[0].tracked = false;
  (void)follow();
  EXPECT_FALSE(uses.tip()) << "it is not seen";
}

TEST_F(RoomHandUsesTest, the_tip_stays_with_the_hand_that_presses) {
  at(0, -kAway, 0.0);
  at(1, kAway, 0.0);
  (void)follow();
  hands[1].trigger = 1.0;
  (void)follow();
  const std::uint64_t press = uses.tip()->press;
  hands[0].trigger = 1.0;
  (void)follow();
  EXPECT_EQ(uses.tip()->hand, 1U);
  EXPECT_EQ(uses.tip()->press, press);
  hands[1].trigger = 0.0;
  (void)follow();
  EXPECT_EQ(uses.tip()->hand, 1U) << "what was pressed beside it begins nothing";
  EXPECT_FALSE(uses.tip()->pressed);
  hands[0].trigger = 0.0;
  (void)follow();
  hands[0].trigger = 1.0;
  (void)follow();
  EXPECT_EQ(uses.tip()->hand, 0U);
  EXPECT_EQ(uses.tip()->press, press + 1);
  hands[0].trigger = 0.0;
  (void)follow();
  hands[0].trigger = 1.0;
  (void)follow();
  EXPECT_EQ(uses.tip()->press, press + 2) << "each press has a number of its own";
}

TEST_F(RoomHandUsesTest, a_trigger_held_while_the_hand_was_not_seen_is_no_press) {
  at(1, kAway, 0.0);
  (void)follow();
  hands[1].trigger = 1.0;
  (void)follow();
  const std::uint64_t press = uses.tip()->press;
  hands[1].tracked = false;
  (void)follow();
  EXPECT_FALSE(uses.tip());
  hands[1].tracked = true;
  (void)follow();
  EXPECT_FALSE(uses.tip()->pressed);
  hands[1].trigger = 0.4;
  (void)follow();
  hands[1].trigger = 1.0;
  (void)follow();
  EXPECT_FALSE(uses.tip()->pressed) << "not let go yet";
  hands[1].trigger = 0.0;
  (void)follow();
  hands[1].trigger = 1.0;
  (void)follow();
  EXPECT_TRUE(uses.tip()->pressed);
  EXPECT_EQ(uses.tip()->press, press + 1);
}

TEST_F(RoomHandUsesTest, a_hand_that_appears_with_a_held_trigger_clicks_nothing) {
  at(1, 0.0, 0.0);
  hands[1].trigger = 1.0;
  const auto input = follow();
  ASSERT_EQ(input.size(), 1U);
  EXPECT_EQ(input[0].kind, Kind::kMove);
}

TEST_F(RoomHandUsesTest, a_squeeze_during_a_stroke_neither_ends_it_nor_holds_the_field) {
  at(1, kAway, 0.0);
  (void)follow();
  hands[1].trigger = 1.0;
  (void)follow();
  hands[1].squeeze = 1.0;
  (void)follow();
  ASSERT_TRUE(uses.tip());
  EXPECT_TRUE(uses.tip()->pressed);
  EXPECT_EQ(uses.holding()[1].squeeze, 0.0);
  hands[1].trigger = 0.0;
  (void)follow();
  (void)follow();
  EXPECT_EQ(uses.holding()[1].squeeze, 0.0) << "the field does not jump to the hand after it";
  hands[1].squeeze = 0.0;
  (void)follow();
  hands[1].squeeze = 1.0;
  (void)follow();
  EXPECT_EQ(uses.holding()[1].squeeze, 1.0);
  hands[1].trigger = 1.0;
  (void)follow();
  hands[1].squeeze = 0.0;
  (void)follow();
  EXPECT_FALSE(uses.tip()->pressed) << "letting go begins no stroke";
}

TEST_F(RoomHandUsesTest, the_button_does_nothing_under_a_tip_that_is_pressed) {
  at(0, -kAway, 0.0);
  at(1, kAway, 0.0);
  (void)follow();
  hands[0].button = true;
  (void)follow();
  EXPECT_TRUE(uses.holding()[0].button);
  hands[0].button = false;
  hands[1].trigger = 1.0;
  (void)follow();
  hands[0].button = true;
  (void)follow();
  EXPECT_FALSE(uses.holding()[0].button);
  hands[1].trigger = 0.0;
  (void)follow();
  EXPECT_FALSE(uses.holding()[0].button) << "nor after it, until it is pressed again";
  hands[0].button = false;
  (void)follow();
  hands[0].button = true;
  (void)follow();
  EXPECT_TRUE(uses.holding()[0].button);
}

TEST_F(RoomHandUsesTest, hands_that_vanish_let_go_of_what_they_hold_on_the_screen) {
  at(1, 0.0, 0.0);
  (void)follow();
  hands[1].trigger = 1.0;
  (void)follow();
  hands = {};
  const auto input = follow();
  ASSERT_EQ(input.size(), 2U);
  EXPECT_EQ(input[0].kind, Kind::kUp);
  EXPECT_EQ(input[1].kind, Kind::kLeave);
}

TEST(ScreenInput, what_waits_loses_places_and_no_release) {
  std::vector<ScreenInput> waiting;
  for (int i = 0; i < 100; ++i) appendInput({Kind::kMove, 0.01 * i, 0.5, 0.0}, waiting);
  ASSERT_EQ(waiting.size(), 1U);
  EXPECT_NEAR(waiting[0].x, 0.99, 1e-12);
  appendInput({Kind::kDown, 0.99, 0.5, 0.0}, waiting);
  appendInput({Kind::kMove, 0.2, 0.5, 0.0}, waiting);
  appendInput({Kind::kUp, 0.2, 0.5, 0.0}, waiting);
  ASSERT_EQ(waiting.size(), 4U);
  EXPECT_NEAR(waiting[0].x, 0.99, 1e-12) << "where it was pressed";
  while (waiting.size() < 100'000) {
    const std::size_t before = waiting.size();
    appendInput({Kind::kDown}, waiting);
    if (waiting.size() == before) break;
  }
  ASSERT_LT(waiting.size(), 100'000U) << "it has an end";
  appendInput({Kind::kUp}, waiting);
  appendInput({Kind::kLeave}, waiting);
  EXPECT_EQ(waiting[waiting.size() - 2].kind, Kind::kUp);
  EXPECT_EQ(waiting.back().kind, Kind::kLeave);
}

TEST_F(RoomHandUsesTest, a_thumbstick_scrolls_by_time) {
  at(1, 0.0, 0.0);
  (void)follow();
  hands[1].scroll = 0.1;
  EXPECT_TRUE(follow().empty()) << "a stick at rest";
  hands[1].scroll = -1.0;
  double steps = 0.0;
  for (int i = 0; i < 100; ++i)
    for (const ScreenInput& input : follow()) steps += input.kind == Kind::kWheel ? input.wheel : 0.0;
  EXPECT_NEAR(steps, -10.0, 1e-9);
}

TEST_F(RoomHandUsesTest, a_squeeze_on_the_screen_carries_it_and_elsewhere_does_not) {
  at(1, 0.1, 0.0);
  (void)follow();
  hands[1].squeeze = 1.0;
  (void)follow();
  EXPECT_TRUE(uses.carries(1));
  const glm::dvec3 before = screen.panel().pose.position_m;
  const glm::dquat quarter(std::sqrt(0.5), 0.0, std::sqrt(0.5), 0.0);  // to the left
  hands[1].aim.turn = quarter;
  (void)follow();
  // The screen was 0.65 m ahead and 0.1 m to the left of the hand.
  const glm::dvec3 hand = hands[1].aim.position_m;
  EXPECT_NEAR(glm::length(screen.panel().pose.position_m - (hand + glm::dvec3(-0.65, 0.0, 0.1))), 0.0, 1e-9);
  EXPECT_GT(glm::length(screen.panel().pose.position_m - before), 0.5);
  EXPECT_TRUE(uses.pointing());
  hands[1].squeeze = 0.0;
  (void)follow();
  EXPECT_FALSE(uses.carries(1));
  at(0, -kAway, 0.0);
  hands[0].squeeze = 1.0;
  (void)follow();
  EXPECT_FALSE(uses.carries(0));
}

TEST_F(RoomHandUsesTest, a_screen_is_pointed_at_from_its_front_alone) {
  at(1, 0.0, 0.0);
  hands[1].aim.position_m.z = -2.0;  // behind it, away from it
  EXPECT_TRUE(follow().empty());
  hands[1].aim.turn = glm::dquat(0.0, 0.0, 1.0, 0.0);  // towards it
  EXPECT_TRUE(follow().empty());
}

TEST(RoomScreen, a_ray_is_flat_to_the_head_and_ends_where_it_ends) {
  const glm::dvec3 from(0.2, 1.0, -0.3), to(0.0, 1.5, -1.2), head(0.0, 1.6, 0.0);
  const render::RoomPanel ray = RoomScreen::ray(from, to, head);
  const glm::dvec3 half = 0.5 * ray.height_m * (ray.pose.turn * glm::dvec3(0.0, 1.0, 0.0));
  EXPECT_NEAR(glm::length(ray.pose.position_m + half - to), 0.0, 1e-9);
  EXPECT_NEAR(glm::length(ray.pose.position_m - half - from), 0.0, 1e-9);
  const glm::dvec3 front = ray.pose.turn * glm::dvec3(0.0, 0.0, 1.0);
  EXPECT_GT(glm::dot(front, head - ray.pose.position_m), 0.3);
  EXPECT_NEAR(glm::dot(ray.pose.turn * glm::dvec3(1.0, 0.0, 0.0), head - ray.pose.position_m), 0.0, 1e-9);
}

}  // namespace
}  // namespace fettle::app
