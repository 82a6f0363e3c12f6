#include "app/window/list_press.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

using namespace std::chrono_literals;
const ListPress::Clock::time_point kBegin{1h};

TEST(ListPress, the_second_press_of_a_double_click_in_a_list_is_not_for_what_lay_below) {
  ListPress list;
  EXPECT_FALSE(list.press(100.0, 50.0, true, kBegin));
  EXPECT_TRUE(list.repeats(103.0, 52.0, kBegin + 200ms));
  EXPECT_TRUE(list.press(100.0, 50.0, false, kBegin + 200ms));
  EXPECT_TRUE(list.press(100.0, 50.0, false, kBegin + 600ms)) << "the third one";
  EXPECT_FALSE(list.press(100.0, 50.0, false, kBegin + 1200ms)) << "a hand that came back";
}

TEST(ListPress, presses_elsewhere_later_and_in_the_open_list_count) {
  ListPress list;
  (void)list.press(100.0, 50.0, true, kBegin);
  EXPECT_FALSE(list.press(100.0, 60.0, false, kBegin + 200ms)) << "elsewhere";
  EXPECT_FALSE(list.press(100.0, 60.0, false, kBegin + 300ms)) << "a double click of its own";
  (void)list.press(100.0, 50.0, true, kBegin + 1s);
  EXPECT_FALSE(list.press(100.0, 50.0, true, kBegin + 1200ms)) << "the list is still there";
  EXPECT_FALSE(list.press(100.0, 50.0, false, kBegin + 1700ms)) << "half a second later";
}

}  // namespace
}  // namespace fettle::app
