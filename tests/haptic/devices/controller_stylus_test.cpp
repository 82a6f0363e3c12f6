// A headset's controller as the tip, in the mouse's place.
#include "haptic/devices/virtual/controller_stylus.h"

#include <cmath>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

namespace fettle::haptic {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000;

struct ControllerStylusTest : ::testing::Test {
  std::shared_ptr<ControllerLink> link = std::make_shared<ControllerLink>();
  ControllerStylus device{MouseFeel{}, link};
  std::int64_t now_ns = kTick_ns;
  ControllerHand hand_now;

  void SetUp() override { tick(); }  // before any press
  DeviceInput tick() { return device.readAt(now_ns += kTick_ns); }
  DeviceInput ticks(int count) {
    DeviceInput last;
    for (int i = 0; i < count; ++i) last = tick();
    return last;
  }
  // Its number rises with each press, as the headset's thread counts.
  void hand(const glm::dvec3& at, bool pressed) {
    ControllerHand hand = hand_now;
    hand.tip = true;
    hand.press += pressed && !hand_now.pressed ? 1 : 0;
    hand.reader = link->reader;
    hand.pressed = pressed;
    hand.when_ns = now_ns;
    hand.position_mm = at;
    link->hand.publish(hand);
    hand_now = hand;
  }
};

TEST_F(ControllerStylusTest, the_mouse_is_the_tip_until_a_trigger_is_pressed) {
  device.mouse().setCursor({5.0, 5.0, 0.0});
  EXPECT_NEAR(ticks(200).position_mm.x, 5.0, 1e-6);
  hand({20.0, 10.0, 3.0}, false);
  EXPECT_NEAR(tick().position_mm.x, 5.0, 1e-6) << "a hand that is only seen is not the tip";
  hand({20.0, 10.0, 3.0}, true);
  const DeviceInput lifted = tick();
  EXPECT_TRUE(std::isnan(lifted.position_mm.x)) << "nothing is drawn on the way";
  EXPECT_EQ(lifted.buttons, 0U);
  const DeviceInput first = tick();
  EXPECT_EQ(first.position_mm, glm::dvec3(20.0, 10.0, 3.0));
  EXPECT_EQ(first.buttons, kPrimaryButton);
  EXPECT_EQ(first.link, LinkState::kConnected);
  EXPECT_FALSE(first.tool) << "the tool chosen in the window";
  EXPECT_TRUE(first.orientation);
  EXPECT_TRUE(link->leads);
  hand({20.0, 10.0, 3.0}, false);
  EXPECT_EQ(tick().buttons, 0U);
  EXPECT_TRUE(link->leads) << "it stays the tip";
}

TEST_F(ControllerStylusTest, a_stroke_of_the_mouse_takes_the_tip_back) {
  hand({20.0, 10.0, 3.0}, true);
  ticks(3);
  hand({20.0, 10.0, 3.0}, false);
  ticks(3);
  device.mouse().setCursor({5.0, 5.0, 0.0});
  device.mouse().press(Tool::kSmooth);
  bool lifted = false, drew = false;
  for (int i = 0; i < 100; ++i) {
    const DeviceInput input = tick();
    lifted = lifted || std::isnan(input.position_mm.x);
    drew = drew || (lifted && input.tool == Tool::kSmooth && input.position_mm.z < 0.0);
    EXPECT_FALSE(!lifted && input.tool) << "a lift comes first";
  }
  EXPECT_TRUE(drew);
  EXPECT_FALSE(link->leads);
}

TEST_F(ControllerStylusTest, a_stroke_has_one_hand) {
  device.mouse().setCursor({5.0, 5.0, 0.0});
  ticks(50);
  device.mouse().press(Tool::kSmooth);
  ticks(50);
  hand({20.0, 10.0, 3.0}, true);
  const DeviceInput input = ticks(20);
  EXPECT_EQ(input.tool, Tool::kSmooth);
  EXPECT_NEAR(input.position_mm.x, 5.0, 1e-6);
  device.mouse().release();
  ticks(50);
  EXPECT_TRUE(link->leads) << "then it is the one that still presses";
}

TEST_F(ControllerStylusTest, the_tip_moves_with_the_ticks_between_frames) {
  hand({0.0, 0.0, 0.0}, true);
  ticks(2);
  hand({11.0, 0.0, 0.0}, true);
  double before = 0.0;
  for (int i = 0; i < 11; ++i) {
    const double x = tick().position_mm.x;
    EXPECT_GT(x, before);
    EXPECT_LT(x - before, 1.5) << "no jump in a tick";
    before = x;
  }
  hand({11.0, 0.0, 0.0}, true);
  EXPECT_NEAR(ticks(100).position_mm.x, 11.0, 0.01);
}

TEST_F(ControllerStylusTest, frames_that_stay_away_lift_it) {
  hand({1.0, 2.0, 3.0}, true);
  ticks(2);
  EXPECT_EQ(ticks(1900).buttons, kPrimaryButton);
  ticks(200);
  EXPECT_FALSE(link->leads);
  EXPECT_EQ(tick().buttons, 0U);
  hand({1.0, 2.0, 3.0}, false);
  ticks(2);
  EXPECT_TRUE(link->leads) << "it is the tip again when they come";
}

TEST_F(ControllerStylusTest, a_hand_that_may_not_be_the_tip_lifts_it) {
  hand({1.0, 2.0, 3.0}, true);
  ticks(2);
  link->hand.publish({});
  EXPECT_TRUE(std::isnan(tick().position_mm.x));
  EXPECT_EQ(tick().buttons, 0U);
  EXPECT_FALSE(link->leads);
  EXPECT_EQ(ticks(10).link, LinkState::kConnected) << "nothing was unplugged";
  EXPECT_TRUE(std::isnan(tick().position_mm.x)) << "the mouse was nowhere yet";
}

TEST_F(ControllerStylusTest, what_is_touched_is_shown_to_the_hand_that_touches_alone) {
  const Touched touched{true, {1.0, 2.0, 3.0}, {0.0, 0.0, 4.0}, 0.5};
  device.mouse().setCursor({5.0, 5.0, 0.0});
  ticks(5);
  device.show(touched);
  ASSERT_TRUE(link->touched.take());
  EXPECT_FALSE(link->touched.latest().contact) << "the mouse's contact";
  hand({1.0, 2.0, 2.0}, true);
  ticks(2);
  device.show(touched);
  ASSERT_TRUE(link->touched.take());
  EXPECT_EQ(link->touched.latest().strength, 0.5);
  device.stop();
  ASSERT_TRUE(link->touched.take());
  EXPECT_EQ(link->touched.latest().strength, 0.0);
  EXPECT_FALSE(link->leads);
}

TEST_F(ControllerStylusTest, another_press_lifts_it_and_it_goes_on_there) {
  hand({1.0, 2.0, -3.0}, true);
  ticks(20);
  // The other hand's press, or a jump of the coordinates: the tip is elsewhere, and nothing lies between.
  ++hand_now.press;
  hand({50.0, 2.0, -3.0}, true);
  const DeviceInput lifted = tick();
  EXPECT_TRUE(std::isnan(lifted.position_mm.x));
  EXPECT_EQ(lifted.buttons, 0U);
  const DeviceInput there = tick();
  EXPECT_EQ(there.position_mm, glm::dvec3(50.0, 2.0, -3.0)) << "not on the way";
  EXPECT_EQ(there.buttons, kPrimaryButton);
  EXPECT_TRUE(link->leads);
}

TEST_F(ControllerStylusTest, a_press_held_over_frames_that_stayed_away_draws_nothing_more) {
  hand({1.0, 2.0, 3.0}, true);
  ticks(2100);
  hand({1.0, 2.0, 3.0}, true);
  EXPECT_EQ(ticks(5).buttons, 0U) << "the same press";
  EXPECT_TRUE(link->leads) << "it feels the surface";
  hand({1.0, 2.0, 3.0}, false);
  ticks(5);
  hand({1.0, 2.0, 3.0}, true);
  EXPECT_EQ(ticks(5).buttons, kPrimaryButton);
}

TEST_F(ControllerStylusTest, a_press_held_while_the_hand_was_no_tip_draws_nothing_more) {
  hand({1.0, 2.0, 3.0}, true);
  ticks(5);
  link->hand.publish({});
  ticks(5);
  hand({1.0, 2.0, 3.0}, true);
  EXPECT_EQ(ticks(5).buttons, 0U);
}

TEST_F(ControllerStylusTest, another_field_takes_no_press_and_no_place_of_the_last_one) {
  hand({1.0, 2.0, 3.0}, true);
  ticks(5);
  device.stop();
  ControllerStylus next{MouseFeel{}, link};
  const auto read = [&](int count) {
    DeviceInput input;
    for (int i = 0; i < count; ++i) input = next.readAt(now_ns += kTick_ns);
    return input;
  };
  read(5);
  EXPECT_FALSE(link->leads) << "a place on the last field";
  hand({7.0, 8.0, 9.0}, true);  // of the next one from here on
  EXPECT_EQ(read(5).buttons, 0U);
  EXPECT_FALSE(link->leads) << "a press of the last one";
  hand({7.0, 8.0, 9.0}, false);
  read(5);
  hand({7.0, 8.0, 9.0}, true);
  const DeviceInput begun = read(5);
  EXPECT_EQ(begun.buttons, kPrimaryButton);
  EXPECT_EQ(begun.position_mm, glm::dvec3(7.0, 8.0, 9.0));
}

TEST_F(ControllerStylusTest, a_loop_that_starts_again_takes_no_press_held_meanwhile) {
  hand({1.0, 2.0, 3.0}, true);
  ticks(5);
  device.stop();
  hand({1.0, 2.0, 3.0}, true);
  EXPECT_EQ(ticks(5).buttons, 0U);
  EXPECT_FALSE(link->leads);
}

TEST_F(ControllerStylusTest,
       while_a_question_is_asked_a_trigger_does_nothing_and_what_was_held_neither_after_it) {
  hand({1.0, 2.0, 3.0}, true);
  EXPECT_EQ(ticks(5).buttons, kPrimaryButton);
  link->asked = true;
  EXPECT_EQ(tick().buttons, 0U);
  hand({1.0, 2.0, 3.0}, false);
  ticks(5);
  hand({1.0, 2.0, 3.0}, true);
  EXPECT_EQ(ticks(5).buttons, 0U);
  link->asked = false;
  EXPECT_EQ(ticks(5).buttons, 0U) << "pressed while it was asked";
  hand({1.0, 2.0, 3.0}, false);
  ticks(5);
  hand({1.0, 2.0, 3.0}, true);
  EXPECT_EQ(ticks(5).buttons, kPrimaryButton);
}

TEST_F(ControllerStylusTest, its_numbers_never_fall_whoever_leads) {
  std::uint64_t before = 0;
  const auto rises = [&](int count) {
    for (int i = 0; i < count; ++i) {
      const std::uint64_t now = tick().sequence;
      EXPECT_GE(now, before);
      before = now;
    }
  };
  rises(5);
  EXPECT_EQ(before, 0U) << "the mouse was nowhere";
  hand({1.0, 2.0, 3.0}, true);
  rises(10);
  link->hand.publish({});
  rises(10);
  device.mouse().setCursor({5.0, 5.0, 0.0});
  rises(10);
}

}  // namespace
}  // namespace fettle::haptic
