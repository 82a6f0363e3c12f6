#include "app/window/device_renewal.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

using std::chrono::milliseconds;
using Clock = DeviceRenewal::Clock;

TEST(DeviceRenewal, tries_at_once_then_later_and_later_and_at_last_no_more) {
  DeviceRenewal renewal;
  Clock::time_point now{std::chrono::hours(1)};
  for (const int pause_ms : {0, 100, 300, 800, 1500, 2500}) {
    ASSERT_TRUE(renewal.lost(0, now)) << pause_ms;
    EXPECT_FALSE(renewal.due(now + milliseconds(pause_ms - 1)));
    now += milliseconds(pause_ms);
    EXPECT_TRUE(renewal.due(now));
    renewal.begin(0);
  }
  EXPECT_FALSE(renewal.lost(0, now));
  EXPECT_EQ(renewal.losses(), 7);
}

TEST(DeviceRenewal, a_device_that_showed_some_frames_has_come_back) {
  DeviceRenewal renewal;
  const Clock::time_point now{std::chrono::hours(1)};
  for (std::uint64_t frames = 3; frames < 60; frames += 3) {
    ASSERT_TRUE(renewal.lost(frames, now)) << frames;
    EXPECT_TRUE(renewal.due(now)) << "without a pause";
    renewal.begin(frames);
  }
  // Two frames are too few.
  int tries = 0;
  for (std::uint64_t frames = 60; renewal.lost(frames, now); frames += 2, ++tries) renewal.begin(frames);
  EXPECT_EQ(tries, 6);
}

}  // namespace
}  // namespace fettle::app
