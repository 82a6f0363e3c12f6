#include "app/work/behind_the_window.h"

#include <sys/resource.h>
#include <unistd.h>

#include <mutex>
#include <set>
#include <thread>

#include <gtest/gtest.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include "app/work/background.h"

namespace fettle::app {
namespace {

int nice() {
  return getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()));
}

// In a thread of its own: what is allowed to come before others need not be allowed to go back.
bool windowComesBefore() {
  bool allowed = false;
  std::thread([&] { allowed = comeBeforeOtherWork(); }).join();
  return allowed;
}

TEST(BehindTheWindow, AllWorkersAreAndTheThreadThatAsksIsNot) {
  const int before = nice();
  const int behind = std::max(before, windowComesBefore() ? 0 : 10);
  EXPECT_EQ(putWorkersBehindTheWindow(), tbb::info::default_concurrency() - 1);
  EXPECT_EQ(nice(), before);
  const std::thread::id here = std::this_thread::get_id();
  std::mutex mutex;
  std::set<int> of_workers;
  tbb::parallel_for(0, 10000, [&](int) {
    if (std::this_thread::get_id() == here) return;
    const std::lock_guard lock(mutex);
    of_workers.insert(nice());
  });
  for (const int worker : of_workers) EXPECT_EQ(worker, behind);
}

TEST(BehindTheWindow, WhatDrawsComesBeforeOthersWhereItMay) {
  const int before = nice();
  std::thread([&] {
    const bool allowed = comeBeforeOtherWork();
    EXPECT_EQ(nice(), allowed ? -10 : before);
    std::thread([&] { EXPECT_EQ(nice(), allowed ? -10 : before) << "a thread of its own"; }).join();
    goBehindTheWindow();
    EXPECT_EQ(nice(), allowed ? 0 : 10);
  }).join();
  EXPECT_EQ(nice(), before);
}

TEST(BehindTheWindow, ALongJobIs) {
  const int behind = std::max(nice(), windowComesBefore() ? 0 : 10);
  Background<int> job;
  job.start([](engine::JobControl&) -> engine::Result<int> { return nice(); });
  const auto done = job.wait();
  ASSERT_TRUE(done);
  ASSERT_TRUE(*done);
  EXPECT_EQ(**done, behind);
}

}  // namespace
}  // namespace fettle::app
