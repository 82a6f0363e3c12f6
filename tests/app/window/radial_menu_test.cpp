#include "app/window/radial_menu.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

using render::InputEvent;
using render::InputKind;
using render::Key;
using render::MouseButton;
using By = RadialMenu::By;

const render::Rectangle kSeen{0, 20, 800, 600};
constexpr glm::dvec2 kCursor{400, 300};

InputEvent moveTo(const glm::dvec2& at) {
  InputEvent event;
  event.kind = InputKind::kMove;
  event.x = at.x;
  event.y = at.y;
  return event;
}
InputEvent keyDown(Key key, bool repeat = false) {
  InputEvent event;
  event.kind = InputKind::kKeyDown;
  event.key = key;
  event.repeat = repeat;
  return event;
}
InputEvent keyUp(Key key) {
  InputEvent event = keyDown(key);
  event.kind = InputKind::kKeyUp;
  return event;
}
InputEvent button(InputKind kind, MouseButton which, const glm::dvec2& at) {
  InputEvent event = moveTo(at);
  event.kind = kind;
  event.button = which;
  return event;
}
// So far from `from` in the direction of an item, `off` items beside it.
glm::dvec2 towards(std::size_t item, double px, double off = 0.0, const glm::dvec2& from = kCursor) {
  const double turn = (static_cast<double>(item) + off) / RadialMenu::kItems.size() * 2.0 * std::numbers::pi;
  return from + px * glm::dvec2(std::sin(turn), -std::cos(turn));
}
RadialMenu opened(By by = By::kKey, const glm::dvec2& cursor = kCursor, double scale = 1.0) {
  RadialMenu menu;
  menu.open(cursor, kSeen, scale, by);
  return menu;
}

TEST(RadialMenu, the_direction_chooses_when_the_key_is_released) {
  for (std::size_t i = 0; i < RadialMenu::kItems.size(); ++i)
    for (const double off : {-0.45, 0.0, 0.45}) {
      RadialMenu menu = opened();
      EXPECT_TRUE(menu.handle(moveTo(towards(i, 60.0, off))).used);
      EXPECT_EQ(menu.pointed(), i);
      EXPECT_TRUE(menu.handle(keyDown(RadialMenu::kKey, true)).used) << "the held key repeats";
      const RadialMenu::Outcome outcome = menu.handle(keyUp(RadialMenu::kKey));
      EXPECT_EQ(outcome.chosen, RadialMenu::kItems[i].action);
      EXPECT_FALSE(menu.active());
    }
}

TEST(RadialMenu, the_middle_and_escape_choose_nothing) {
  RadialMenu menu = opened();
  (void)menu.handle(moveTo(towards(2, 60.0)));
  (void)menu.handle(moveTo(towards(2, RadialMenu::kMiddle_px - 1.0)));
  EXPECT_FALSE(menu.pointed());
  const RadialMenu::Outcome back = menu.handle(keyUp(RadialMenu::kKey));
  EXPECT_TRUE(back.used);
  EXPECT_FALSE(back.chosen);
  EXPECT_FALSE(menu.active());

  menu = opened();
  (void)menu.handle(moveTo(towards(2, 60.0)));
  const RadialMenu::Outcome escaped = menu.handle(keyDown(Key::kEscape));
  EXPECT_TRUE(escaped.used) << "it ends nothing else";
  EXPECT_FALSE(escaped.chosen);
  EXPECT_FALSE(menu.active());
  EXPECT_FALSE(menu.handle(keyUp(RadialMenu::kKey)).used);
}

TEST(RadialMenu, a_tap_leaves_it_open_for_a_click_or_enter) {
  RadialMenu menu = opened();
  EXPECT_FALSE(menu.handle(keyUp(RadialMenu::kKey)).chosen);
  EXPECT_TRUE(menu.active());
  EXPECT_EQ(menu.handle(button(InputKind::kButtonDown, MouseButton::kLeft, towards(3, 90.0))).chosen,
            RadialMenu::kItems[3].action);
  EXPECT_FALSE(menu.active());

  menu = opened(By::kButton);
  EXPECT_FALSE(menu.handle(button(InputKind::kButtonUp, MouseButton::kRight, kCursor)).chosen);
  EXPECT_TRUE(menu.active());
  const RadialMenu::Outcome beside = menu.handle(button(InputKind::kButtonDown, MouseButton::kLeft, kCursor));
  EXPECT_TRUE(beside.used);
  EXPECT_FALSE(beside.chosen);
  EXPECT_FALSE(menu.active());
}

TEST(RadialMenu, the_second_button_chooses_when_it_is_released_and_no_other_does) {
  RadialMenu menu = opened(By::kButton);
  (void)menu.handle(moveTo(towards(1, 60.0)));
  EXPECT_FALSE(menu.handle(button(InputKind::kButtonUp, MouseButton::kMiddle, towards(1, 60.0))).chosen);
  EXPECT_FALSE(menu.handle(keyUp(RadialMenu::kKey)).chosen);
  EXPECT_TRUE(menu.active());
  EXPECT_EQ(menu.handle(button(InputKind::kButtonUp, MouseButton::kRight, towards(1, 60.0))).chosen,
            RadialMenu::kItems[1].action);
}

TEST(RadialMenu, arrow_keys_reach_every_item) {
  RadialMenu menu = opened();
  (void)menu.handle(keyUp(RadialMenu::kKey));
  const auto after = [&](Key key) {
    EXPECT_TRUE(menu.handle(keyDown(key)).used);
    return menu.pointed();
  };
  EXPECT_EQ(after(Key::kUp), 0U);
  EXPECT_EQ(after(Key::kRight), 1U);
  EXPECT_EQ(after(Key::kRight), 2U);
  EXPECT_EQ(after(Key::kRight), 2U);
  EXPECT_EQ(after(Key::kDown), 3U);
  EXPECT_EQ(after(Key::kDown), 4U);
  EXPECT_EQ(after(Key::kLeft), 5U);
  EXPECT_EQ(after(Key::kUp), 6U);
  EXPECT_EQ(after(Key::kUp), 7U);
  EXPECT_EQ(menu.handle(keyDown(Key::kEnter)).chosen, RadialMenu::kItems[7].action);
  // With the key held all the while, too.
  menu = opened();
  EXPECT_EQ(after(Key::kLeft), 6U);
  EXPECT_EQ(menu.handle(keyUp(RadialMenu::kKey)).chosen, RadialMenu::kItems[6].action);
}

TEST(RadialMenu, another_key_ends_it_and_does_what_it_does) {
  RadialMenu menu = opened();
  EXPECT_FALSE(menu.handle(keyDown(render::letter('Z'))).used);
  EXPECT_FALSE(menu.active());
}

TEST(RadialMenu, it_is_drawn_whole_and_directions_count_from_the_cursor) {
  const glm::dvec2 corner{3, 22};
  for (const double scale : {1.0, 2.0}) {
    RadialMenu menu = opened(By::kKey, corner, scale);
    // As far as the names reach, longer ones to one side.
    const RadialMenu::Reach reach{150 * scale, 105 * scale, 170 * scale, 100 * scale};
    EXPECT_GE(menu.drawnAt(reach).x, reach.left);
    EXPECT_GE(menu.drawnAt(reach).y, 20.0 + reach.up);
    const RadialMenu other = opened(By::kKey, {797, 618}, scale);
    EXPECT_LE(other.drawnAt(reach).x, 800.0 - reach.right);
    EXPECT_LE(other.drawnAt(reach).y, 620.0 - reach.down);
    EXPECT_EQ(opened(By::kKey, kCursor, scale).drawnAt(reach), kCursor) << "where there is room";
    (void)menu.handle(moveTo(towards(4, 40.0 * scale, 0.0, corner)));
    EXPECT_EQ(menu.pointed(), 4U);
    (void)menu.handle(moveTo(towards(4, 20.0 * scale, 0.0, corner)));
    EXPECT_FALSE(menu.pointed());
  }
  // A picture that is too small for it shows its middle.
  RadialMenu menu;
  menu.open({5, 5}, {0, 0, 100, 60}, 1.0, By::kKey);
  EXPECT_EQ(menu.drawnAt({150, 100, 150, 100}), glm::dvec2(50, 30));
}

TEST(RadialMenu, of_a_device_is_pointed_at_by_its_tip_and_chosen_by_its_button) {
  RadialMenu menu = opened(By::kDevice);
  EXPECT_TRUE(menu.ofDevice());
  // The cursor is elsewhere, and does not point.
  EXPECT_TRUE(menu.handle(moveTo(towards(4, 90.0))).used);
  EXPECT_FALSE(menu.pointed());
  menu.follow(towards(2, 90.0));
  EXPECT_EQ(menu.pointed(), 2U);
  EXPECT_EQ(menu.letGo().chosen, RadialMenu::kItems[2].action);
  EXPECT_FALSE(menu.active());
  // A tap leaves it open, and the next press chooses.
  menu = opened(By::kDevice);
  EXPECT_FALSE(menu.letGo().chosen);
  EXPECT_TRUE(menu.ofDevice());
  menu.follow(towards(6, 90.0));
  EXPECT_FALSE(menu.letGo().chosen) << "the button is not held";
  EXPECT_EQ(menu.pressAgain().chosen, RadialMenu::kItems[6].action);
  // One that a key opened is not the device's.
  menu = opened(By::kKey);
  EXPECT_FALSE(menu.ofDevice());
  EXPECT_FALSE(menu.letGo().used);
}

}  // namespace
}  // namespace fettle::app
