#include <atomic>
#include <mutex>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/field/difference.h"
#include "engine/field/live_field.h"

namespace fettle::engine {
namespace {

// The newest version, handed from the owner to readers. A mutex is fine here: the test is about what lies
// behind the version, not about how it is handed over.
class Latest {
 public:
  void set(Version version) {
    const std::scoped_lock lock(mutex_);
    std::swap(version_, version);
  }
  Version get() {
    const std::scoped_lock lock(mutex_);
    return version_;
  }

 private:
  std::mutex mutex_;
  Version version_;
};

Version flat(int side, float height) {
  Grid grid;
  grid.width = grid.height = side;
  return makeField(grid, std::vector<float>(static_cast<std::size_t>(side * side), height));
}

// The owner writes the same number all over a square that spans four tiles, a new number each time; whoever
// reads a version must see one number only, in samples and in bounds, while the owner continues and versions
// die on every thread.
TEST(SharedVersions, ReadersSeeWholeEditsWhileTheOwnerGoesOnWriting) {
  constexpr int kSide = 160;
  constexpr int kEdits = 4000;
  LiveField live(flat(kSide, 0.0F), Growth::kAllowed);
  Latest latest;
  latest.set(live.snapshot());
  std::atomic<bool> stop{false};
  std::atomic<int> torn{0};
  std::atomic<int> read{0};

  std::vector<std::thread> readers;
  for (int i = 0; i < 2; ++i)
    readers.emplace_back([&] {
      Version kept = latest.get();
      while (!stop.load()) {
        const Version version = latest.get();
        const FieldReader f = version.reader();
        const float first = f.heightAt(40, 40);
        for (int r = 40; r < 90; r += 7)
          for (int c = 40; c < 90; c += 7)
            if (f.heightAt(c, r) != first) torn.fetch_add(1);
        if (f.heightAt(89, 89) != first || f.bounds().max != first) torn.fetch_add(1);
        for (const TileChange& change : changedTiles(kept, version))
          if (change.after->samples[0] < 0.0F) torn.fetch_add(1);
        kept = version;
        read.fetch_add(1);
      }
    });

  std::vector<float> square(50 * 50);
  for (int edit = 1; edit <= kEdits; ++edit) {
    square.assign(square.size(), static_cast<float>(edit));
    ASSERT_TRUE(live.writeHeights(40, 40, 50, 50, square.data(), 50));
    latest.set(live.snapshot());
    if (edit % 16 == 0) std::this_thread::yield();
  }
  while (read.load() < 10) std::this_thread::yield();
  stop.store(true);
  for (std::thread& t : readers) t.join();
  EXPECT_EQ(torn.load(), 0);
  EXPECT_EQ(live.snapshot().reader().heightAt(89, 89), static_cast<float>(kEdits));
}

}  // namespace
}  // namespace fettle::engine
