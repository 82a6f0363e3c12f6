#include "haptic/loop/pool_keeper.h"

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <thread>

#include <gtest/gtest.h>

namespace fettle::haptic {
namespace {

int niceOf(int thread) {
  return getpriority(PRIO_PROCESS, static_cast<id_t>(thread));
}

std::set<int> threads() {
  std::set<int> all;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task"))
    all.insert(std::stoi(entry.path().filename()));
  return all;
}

// Filters take their tiles from the pools that it fills: clearing memory for them is no part of drawing.
TEST(PoolKeeper, DoesNotComeBeforeOthersThoughItsStarterDoes) {
  std::thread([] {
    const auto self = static_cast<id_t>(gettid());
    if (setpriority(PRIO_PROCESS, self, -10) != 0) GTEST_SKIP() << "no thread may come before others here";
    const std::set<int> before = threads();
    const PoolKeeper keeper(std::make_shared<engine::FieldMemory>(), {.tiles = 8, .nodes = 8});
    int own = 0;
    for (const int thread : threads())
      if (!before.contains(thread)) own = thread;
    ASSERT_GT(own, 0);
    // It does so first of all.
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (niceOf(own) != 0 && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
    EXPECT_EQ(niceOf(own), 0);
    EXPECT_EQ(niceOf(static_cast<int>(self)), -10);
  }).join();
}

}  // namespace
}  // namespace fettle::haptic
