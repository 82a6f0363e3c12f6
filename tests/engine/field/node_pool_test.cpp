#include "engine/field/node_pool.h"

#include <algorithm>
#include <atomic>
#include <set>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

TEST(Pool, DryPoolGivesNothingUntilItMayGrow) {
  TilePool pool;
  EXPECT_EQ(pool.tryAcquire(), nullptr);
  TileRef tile = TileRef::adopt(pool.acquire());
  ASSERT_TRUE(tile);
  EXPECT_EQ(pool.liveObjects(), 1U);
  tile = TileRef();
  EXPECT_EQ(pool.liveObjects(), 0U);
}

TEST(Pool, ReserveMakesThatManyDistinctObjectsFree) {
  TilePool pool;
  ASSERT_TRUE(pool.reserve(300));
  std::set<Tile*> seen;
  std::vector<TileRef> held;
  for (int i = 0; i < 300; ++i) {
    held.push_back(TileRef::adopt(pool.tryAcquire()));
    ASSERT_TRUE(held.back());
    EXPECT_TRUE(seen.insert(held.back().get()).second);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(held.back().get()) % 64, 0U);
  }
}

TEST(Pool, CopiesOfAReferenceKeepTheObjectFromBeingRecycled) {
  TilePool pool;
  TileRef a = TileRef::adopt(pool.acquire());
  EXPECT_TRUE(TilePool::unique(a.get()));
  TileRef b = a;
  EXPECT_FALSE(TilePool::unique(a.get()));
  a = TileRef();
  EXPECT_TRUE(TilePool::unique(b.get()));
  EXPECT_EQ(pool.liveObjects(), 1U);
}

// Each thread writes its name all over every tile it gets and looks again before giving it back: a tile
// handed to two threads at once would show a mixture.
TEST(Pool, ThreadsNeverShareATileTheyAcquired) {
  TilePool pool;
  ASSERT_TRUE(pool.reserve(8));
  std::atomic<int> mixtures{0};
  std::vector<std::thread> threads;
  for (int name = 1; name <= 4; ++name)
    threads.emplace_back([&pool, &mixtures, name] {
      for (int i = 0; i < 20000; ++i) {
        TileRef tile = TileRef::adopt(pool.tryAcquire());
        if (!tile) continue;
        tile->marks.fill(static_cast<std::uint64_t>(name));
        if (std::any_of(tile->marks.begin(), tile->marks.end(),
                        [name](std::uint64_t m) { return m != static_cast<std::uint64_t>(name); }))
          mixtures.fetch_add(1);
      }
    });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(mixtures.load(), 0);
  EXPECT_EQ(pool.liveObjects(), 0U);
}

}  // namespace
}  // namespace fettle::engine
