#include "app/window/notice_room.h"

#include <chrono>

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

using namespace std::chrono_literals;
const NoticeRoom::Clock::time_point kBefore{1h};

TEST(NoticeRoom, notices_come_at_once_where_no_hand_works) {
  NoticeRoom room;
  EXPECT_EQ(room.follow(80.0F, kBefore), 80.0F);
  room.press(200.0F, kBefore);  // above what more notices cover
  EXPECT_EQ(room.follow(120.0F, kBefore), 120.0F);
  room.press(100.0F, kBefore);  // on the notices
  EXPECT_EQ(room.follow(160.0F, kBefore), 160.0F);
  EXPECT_FALSE(room.waits());
}

TEST(NoticeRoom, what_was_just_pressed_is_not_covered_for_a_second) {
  NoticeRoom room;
  room.press(50.0F, kBefore);
  EXPECT_EQ(room.follow(80.0F, kBefore + 300ms), 0.0F);
  EXPECT_TRUE(room.waits());
  room.press(50.0F, kBefore + 800ms);  // and again
  EXPECT_EQ(room.follow(80.0F, kBefore + 1700ms), 0.0F);
  EXPECT_EQ(room.follow(80.0F, kBefore + 1800ms), 80.0F);
  EXPECT_FALSE(room.waits());
}

TEST(NoticeRoom, what_a_hand_reaches_for_is_not_covered_until_it_rests_or_leaves) {
  NoticeRoom room;
  room.point(50.0F, 900.0F, kBefore);
  EXPECT_EQ(room.follow(80.0F, kBefore + 2s), 0.0F);
  EXPECT_TRUE(room.waits());
  room.point(50.0F, 901.0F, kBefore + 2s);
  EXPECT_EQ(room.follow(80.0F, kBefore + 4900ms), 0.0F) << "it moves";
  EXPECT_EQ(room.follow(80.0F, kBefore + 5s), 80.0F) << "it rests";
  EXPECT_FALSE(room.waits());
  EXPECT_EQ(room.follow(0.0F, kBefore + 5s), 0.0F);
  room.point(60.0F, 901.0F, kBefore + 6s);
  EXPECT_EQ(room.follow(80.0F, kBefore + 6s), 0.0F);
  room.point(-1.0F, -1.0F, kBefore + 6s);
  EXPECT_EQ(room.follow(80.0F, kBefore + 6s), 80.0F) << "it is elsewhere";
}

TEST(NoticeRoom, what_goes_gives_its_place_back_at_once) {
  NoticeRoom room;
  EXPECT_EQ(room.follow(80.0F, kBefore), 80.0F);
  room.press(100.0F, kBefore);
  EXPECT_EQ(room.follow(120.0F, kBefore), 80.0F);
  EXPECT_EQ(room.follow(40.0F, kBefore), 40.0F);
}

}  // namespace
}  // namespace fettle::app
