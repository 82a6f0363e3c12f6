#include "app/work/background.h"

#include <atomic>
#include <memory>

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

// Until it is told, whatever it is asked.
engine::Result<int> untilTold(const std::atomic<bool>& told, int result) {
  told.wait(false);
  return result;
}

TEST(BackgroundTest, AReplacedJobIsNotWaitedFor) {
  const auto told = std::make_shared<std::atomic<bool>>(false);
  Background<int> job;
  job.start([told](engine::JobControl&) { return untilTold(*told, 1); });
  // With start() this would wait for what is told below.
  job.replace([](engine::JobControl&) -> engine::Result<int> { return 2; });
  const auto second = job.wait();
  ASSERT_TRUE(second);
  ASSERT_TRUE(*second);
  EXPECT_EQ(**second, 2);
  EXPECT_FALSE(job.busy());
  *told = true;
  told->notify_all();
  job.replace([](engine::JobControl&) -> engine::Result<int> { return 3; });
  const auto third = job.wait();
  ASSERT_TRUE(third);
  EXPECT_EQ(**third, 3);
}

TEST(BackgroundTest, ItsEndWaitsForReplacedJobs) {
  const auto told = std::make_shared<std::atomic<bool>>(false);
  const auto ended = std::make_shared<std::atomic<int>>(0);
  {
    Background<int> job;
    for (int i = 0; i < 3; ++i)
      job.replace([told, ended](engine::JobControl&) {
        auto result = untilTold(*told, 1);
        ++*ended;
        return result;
      });
    *told = true;
    told->notify_all();
  }
  EXPECT_EQ(*ended, 3);
}

}  // namespace
}  // namespace fettle::app
