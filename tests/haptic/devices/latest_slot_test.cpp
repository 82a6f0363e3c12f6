#include "haptic/base/latest_slot.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include <gtest/gtest.h>

namespace fettle::haptic {
namespace {

TEST(LatestSlot, StartsWithItsInitialValueAndNothingToTake) {
  LatestSlot<int> slot(7);
  EXPECT_EQ(slot.latest(), 7);
  EXPECT_FALSE(slot.take());
}

TEST(LatestSlot, OnlyTheNewestOfSeveralIsTakenAndOnlyOnce) {
  LatestSlot<int> slot;
  for (int round = 0; round < 10; ++round) {
    for (int i = 0; i <= round; ++i) slot.publish(100 * round + i);
    EXPECT_TRUE(slot.take());
    EXPECT_EQ(slot.latest(), 101 * round);
    EXPECT_FALSE(slot.take());
    EXPECT_EQ(slot.latest(), 101 * round);
  }
}

// Far larger than any atomic: a torn read shows as words that differ.
struct Payload {
  std::array<std::uint64_t, 64> words{};
};

TEST(LatestSlot, NoValueIsTornOrOlderThanTheOneBefore) {
  constexpr std::uint64_t kLast = 200'000;
  LatestSlot<Payload> slot;
  std::atomic<bool> go{false};
  std::thread writer([&] {
    while (!go.load()) {
    }
    Payload p;
    for (std::uint64_t n = 1; n <= kLast; ++n) {
      p.words.fill(n);
      slot.publish(p);
    }
  });
  go.store(true);
  std::uint64_t seen = 0;
  std::uint64_t torn = 0;
  std::uint64_t backwards = 0;
  while (seen != kLast) {
    if (!slot.take()) continue;
    const Payload& p = slot.latest();
    for (const std::uint64_t w : p.words) torn += w == p.words[0] ? 0 : 1;
    backwards += p.words[0] > seen ? 0 : 1;
    seen = p.words[0];
  }
  writer.join();
  EXPECT_EQ(torn, 0U);
  EXPECT_EQ(backwards, 0U);
}

}  // namespace
}  // namespace fettle::haptic
