// A controller's place in the room as the loop is told it, and what it is told of its contact.
#include "app/xr/room_tip.h"

#include <cmath>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "engine/base/stopwatch.h"

namespace fettle::app {
namespace {

// A right hand away from the screen, over a block of 300 x 200 x 10 mm on a table.
struct RoomTipTest : ::testing::Test {
  static constexpr std::uint64_t kReader = 3;

  std::shared_ptr<haptic::ControllerLink> link = std::make_shared<haptic::ControllerLink>();
  RoomTip tip{link};
  RoomScreen screen;
  RoomHandUses uses;
  RoomTable table{RoomScale::kGiant};
  render::Framing framing;
  render::RoomHands hands;

  void SetUp() override {
    framing.shown = framing.drawn = {{-150.0, -100.0, -5.0}, {150.0, 100.0, 5.0}};
    table.place(framing, head(), true);
    hands[1].tracked = true;
    hands[1].aim.position_m = {0.1, 0.8, -0.5};
    (void)frame();
  }
  static render::RoomPose head() { return {{0.0, 1.6, 0.0}, glm::dquat(1.0, 0.0, 0.0, 0.0)}; }
  haptic::ControllerHand frame() {
    uses.follow(hands, 0.01, screen);
    table.follow(uses.holding());
    tip.follow(hands, uses, table, framing, kReader);
    static_cast<void>(link->hand.take());
    return link->hand.latest();
  }
  haptic::ControllerHand press() {
    hands[1].trigger = 1.0;
    return frame();
  }
  haptic::ControllerHand letGo() {
    hands[1].trigger = 0.0;
    return frame();
  }
};

TEST_F(RoomTipTest, a_press_is_told_with_its_place_and_a_number) {
  const haptic::ControllerHand first = press();
  EXPECT_TRUE(first.tip);
  EXPECT_TRUE(first.pressed);
  EXPECT_EQ(first.reader, kReader);
  EXPECT_LT(glm::length(first.position_mm - framing.fieldOf(table.sceneOf({0.1, 0.8, -0.5}))), 1e-9);
  EXPECT_EQ(frame().press, first.press);
  EXPECT_EQ(letGo().press, first.press);
  EXPECT_GT(press().press, first.press);
}

TEST_F(RoomTipTest, a_jump_of_the_coordinates_ends_the_press) {
  const auto expectEnds = [&](const char* what, const auto& jump) {
    const haptic::ControllerHand before = press();
    ASSERT_TRUE(before.pressed) << what;
    jump();
    const haptic::ControllerHand after = frame();
    EXPECT_TRUE(after.tip) << what;
    EXPECT_FALSE(after.pressed) << what;
    EXPECT_GT(after.press, before.press) << what;
    EXPECT_FALSE(frame().pressed) << what << ": it is still held";
    letGo();
  };
  expectEnds("another exaggeration", [&] { framing.exaggeration = 3.0; });
  expectEnds("another framing", [&] { framing.first = {10.0, 0.0}; });
  expectEnds("another height of its table", [&] { framing.reference_mm = 4.0; });
  expectEnds("placed again", [&] { table.place(framing, head(), true); });
  EXPECT_TRUE(press().pressed);
}

TEST_F(RoomTipTest, a_field_that_the_other_hand_moves_is_worked_on) {
  const haptic::ControllerHand before = press();
  hands[0].tracked = true;
  hands[0].grip.position_m = hands[0].aim.position_m = {-0.3, 0.8, -0.4};
  (void)frame();
  hands[0].squeeze = 1.0;
  (void)frame();
  hands[0].grip.position_m.x -= 0.01;
  const haptic::ControllerHand after = frame();
  EXPECT_TRUE(after.pressed);
  EXPECT_EQ(after.press, before.press);
  EXPECT_NEAR(after.position_mm.x - before.position_mm.x, 10.0 / (1e3 * table.metresPerMm()), 1e-6);
}

TEST_F(RoomTipTest, the_button_leaves_the_scale_under_a_pressed_tip) {
  (void)press();
  hands[0].button = true;
  EXPECT_TRUE(frame().pressed);
  EXPECT_EQ(table.scale(), RoomScale::kGiant);
}

TEST_F(RoomTipTest, a_loop_that_stands_still_ends_the_vibration) {
  (void)press();
  link->leads = true;
  haptic::Touched touched{true, {1.0, 2.0, 3.0}, {0.0, 0.0, 4.0}, 0.5, engine::steadyNs()};
  link->touched.publish(touched);
  (void)frame();
  EXPECT_EQ(tip.vibration(1), 0.5);
  touched.when_ns -= 1'000'000'000;
  link->touched.publish(touched);
  (void)frame();
  EXPECT_EQ(tip.vibration(1), 0.0);
}

}  // namespace
}  // namespace fettle::app
