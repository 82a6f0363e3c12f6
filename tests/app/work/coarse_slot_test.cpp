// The rest of a scan waits for its coarse picture, and never for long.
#include "app/work/coarse_slot.h"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kLong = 60s;

TEST(CoarseSlot, WhoWaitsGoesOnOnceThePictureWasShown) {
  CoarseSlot slot;
  engine::JobControl job;
  slot.put({});
  const auto begin = Clock::now();
  std::thread window([&slot] {
    std::this_thread::sleep_for(20ms);
    EXPECT_TRUE(slot.take());
    EXPECT_FALSE(slot.take());
    slot.shown();
  });
  slot.waitShown(kLong, job);
  const auto took = Clock::now() - begin;
  window.join();
  EXPECT_GE(took, 20ms);
  EXPECT_LT(took, kLong / 2);
  slot.waitShown(kLong, job);  // nobody waits twice
  EXPECT_LT(Clock::now() - begin, kLong / 2);
}

TEST(CoarseSlot, AWindowThatShowsNothingIsWaitedForAsLongAsAsked) {
  CoarseSlot slot;
  engine::JobControl job;
  const auto begin = Clock::now();
  slot.waitShown(30ms, job);
  EXPECT_GE(Clock::now() - begin, 30ms);
  EXPECT_LT(Clock::now() - begin, kLong / 2);
}

TEST(CoarseSlot, ACancelEndsTheWaiting) {
  CoarseSlot slot;
  engine::JobControl job;
  const auto begin = Clock::now();
  std::thread user([&job] {
    std::this_thread::sleep_for(20ms);
    job.cancel();
  });
  slot.waitShown(kLong, job);
  user.join();
  EXPECT_LT(Clock::now() - begin, kLong / 2);
}

}  // namespace
}  // namespace fettle::app
