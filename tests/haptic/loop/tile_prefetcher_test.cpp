// A loop over a field on the disk: it feels what has been brought, never waits, and makes the same field.
#include "haptic/loop/tile_prefetcher.h"

#include <cmath>
#include <fstream>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include "engine/field/tile_store.h"
#include "haptic/tick/replay.h"
#include "tests/haptic/loop/hand_device.h"
#include "tests/haptic/support/fields.h"
#include "tests/support/mapped_pages.h"
#include "tests/support/temp_folder.h"

namespace fettle::haptic {
namespace {

using tests::HandDevice;
using tests::sweep;
using tests::testOptions;

constexpr int kStoredSide = 1200;

std::int64_t waits() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_majflt;
}

// A loop whose keeper works when the test says so.
struct StoredBench {
  StoredBench(const engine::Version& start, const Scene& scene, const LoopOptions& options)
      : channels(options),
        loop(std::make_unique<PreparedScene>(scene, start), start, device, channels, options, &near) {}

  void tickAt(const glm::dvec3& tip_mm) {
    device.input.position_mm = tip_mm;
    device.now_ns += 1'000'000;
    loop.run(device.now_ns, 1'000'000);
    for (LoopEvent event; channels.events.pop(event);) newest = std::move(event);
  }

  HandDevice device;
  LoopChannels channels;
  TilePrefetcher near;
  LoopTick loop;
  LoopEvent newest;
};

class TilePrefetcherTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::string folder = folder_.path().string();
    if (const auto store = engine::TileStore::create(folder, 0); !store) GTEST_SKIP() << store.error().line();
    engine::setStorePolicy({.folder = folder, .always = true});
    field_ = fettle::tests::fieldOf(kStoredSide, kStoredSide,
                                    [](int c, int r) { return 0.3 * std::sin(0.9 * c) * std::cos(0.7 * r); });
    ASSERT_TRUE(field_.memory()->tiles.reserve(1000) && field_.memory()->nodes.reserve(200));
    scene_ = defaultScene();
    scene_.brush_radius_samples = 3.0;
  }
  void TearDown() override { engine::setStorePolicy({}); }

  // Everything that may go; whether anything went.
  bool sendOut() const {
    const engine::FieldReader reader = field_.reader();
    bool any = false;
    for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr)
      for (std::int32_t tc = 0; tc < reader.tileColumns(); ++tc)
        any = fettle::tests::Pages(&reader.tile(tc, tr)).sendOut() || any;
    return any;
  }

  fettle::tests::TempFolder folder_;
  engine::Version field_;
  Scene scene_;
};

TEST_F(TilePrefetcherTest, NothingIsFeltBeforeTheTilesAreReadAndEverythingAfter) {
  StoredBench bench(field_, scene_, testOptions(Tool::kFeel));
  for (int i = 0; i < 20; ++i) bench.tickAt({600.0, 600.0, -0.5});
  EXPECT_EQ(bench.loop.state().not_prefetched, 20U);
  EXPECT_FALSE(bench.loop.state().contact);
  bench.near.prefetch();
  bench.tickAt({600.0, 600.0, 1.0});
  bench.tickAt({600.0, 600.0, -0.5});
  EXPECT_EQ(bench.loop.state().not_prefetched, 20U);
  EXPECT_TRUE(bench.loop.state().contact);
  // Somewhere else, quicker than the keeper looks.
  bench.tickAt({50.0, 50.0, -0.5});
  EXPECT_EQ(bench.loop.state().not_prefetched, 21U);
  EXPECT_FALSE(bench.loop.state().contact);
  bench.near.prefetch();
  bench.tickAt({50.0, 50.0, 1.0});
  bench.tickAt({50.0, 50.0, -0.5});
  EXPECT_EQ(bench.loop.state().not_prefetched, 21U);
  EXPECT_TRUE(bench.loop.state().contact);
}

TEST_F(TilePrefetcherTest, AnotherStateIsFeltOnceItsTilesAreThere) {
  engine::LiveField job(field_, engine::Growth::kAllowed);
  for (int r = 590; r < 610; ++r)
    for (int c = 590; c < 610; ++c) ASSERT_TRUE(job.setHeight(c, r, 5.0F));
  StoredBench bench(field_, scene_, testOptions(Tool::kFeel));
  bench.tickAt({600.0, 600.0, 9.0});
  bench.near.prefetch();
  bench.tickAt({600.0, 600.0, 9.0});
  const std::uint64_t before = bench.loop.state().not_prefetched;
  LoopCommand restore;
  restore.kind = CommandKind::kRestore;
  restore.version = job.snapshot();
  ASSERT_TRUE(bench.channels.commands.push(std::move(restore)));
  bench.tickAt({600.0, 600.0, 4.8});
  EXPECT_EQ(bench.loop.state().not_prefetched, before + 1);
  EXPECT_FALSE(bench.loop.state().contact);
  bench.near.prefetch();
  bench.tickAt({600.0, 600.0, 6.0});
  bench.tickAt({600.0, 600.0, 4.8});
  EXPECT_EQ(bench.loop.state().not_prefetched, before + 1);
  EXPECT_TRUE(bench.loop.state().contact);
}

TEST_F(TilePrefetcherTest, TheSystemMayTakeEverythingButWhatIsUnderTheHand) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizers take mlock away";
#endif
  StoredBench bench(field_, scene_, testOptions(Tool::kSmooth));
  bench.tickAt({600.0, 600.0, 1.0});
  bench.near.prefetch();
  bench.near.prefetch();
  if (bench.near.notLocked() > 0) GTEST_SKIP() << "pages cannot be locked here";
  if (!sendOut()) GTEST_SKIP() << "pages cannot be sent out";
  const engine::FieldReader reader = field_.reader();
  const std::int32_t tile = 600 / engine::kTileSide;
  for (std::int32_t tr = tile - TilePrefetcher::kTiles; tr <= tile + TilePrefetcher::kTiles; ++tr)
    for (std::int32_t tc = tile - TilePrefetcher::kTiles; tc <= tile + TilePrefetcher::kTiles; ++tc)
      EXPECT_TRUE(fettle::tests::Pages(&reader.tile(tc, tr)).allInMemory()) << tc << " " << tr;
  EXPECT_FALSE(fettle::tests::Pages(&reader.tile(0, 0)).allInMemory());
  const std::int64_t before = waits();
  for (int i = 0; i < 500; ++i) bench.tickAt({600.0 + 0.1 * i, 600.0 + 0.05 * i, -0.3});
  EXPECT_EQ(waits(), before) << "the loop waited for the disk";
  EXPECT_EQ(bench.loop.state().not_prefetched, 1U);
  // Away from there, nothing is kept where the hand was.
  bench.tickAt({100.0, 100.0, 1.0});
  for (int i = 0; i < 3; ++i) bench.near.prefetch();
  ASSERT_TRUE(sendOut());
  EXPECT_FALSE(fettle::tests::Pages(&reader.tile(tile + 2, tile + 2)).allInMemory());
  EXPECT_TRUE(fettle::tests::Pages(&reader.tile(1, 1)).allInMemory());
}

// In bytes: how much a user's programs may lock is limited (ulimit -l).
std::int64_t lockedBytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmLck:")) return 1024 * std::stoll(line.substr(6));
  return 0;
}

TEST_F(TilePrefetcherTest, OnlyThePagesOfTheTilesUnderTheHandAreLocked) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizers take mlock away";
#endif
  const engine::FieldReader reader = field_.reader();
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  std::set<std::uintptr_t> pages;
  const std::int32_t tile = 600 / engine::kTileSide;
  for (std::int32_t tr = tile - TilePrefetcher::kTiles; tr <= tile + TilePrefetcher::kTiles; ++tr)
    for (std::int32_t tc = tile - TilePrefetcher::kTiles; tc <= tile + TilePrefetcher::kTiles; ++tc) {
      const auto first = reinterpret_cast<std::uintptr_t>(&reader.tile(tc, tr));
      for (std::uintptr_t at = first / page; at <= (first + sizeof(engine::Tile) - 1) / page; ++at)
        pages.insert(at * page);
    }
  const std::int64_t before = lockedBytes();
  bool may = true;
  for (const std::uintptr_t at : pages) may = may && mlock(reinterpret_cast<void*>(at), page) == 0;
  for (const std::uintptr_t at : pages) munlock(reinterpret_cast<void*>(at), page);
  if (!may) GTEST_SKIP() << "pages cannot be locked here";
  StoredBench bench(field_, scene_, testOptions(Tool::kSmooth));
  bench.tickAt({600.0, 600.0, 1.0});
  bench.near.prefetch();
  EXPECT_EQ(bench.near.notLocked(), 0U);
  EXPECT_EQ(lockedBytes() - before, static_cast<std::int64_t>(pages.size() * page));
}

TEST_F(TilePrefetcherTest, ALiveSessionOverTheDiskEqualsTheReplayOfWhatItWasGiven) {
  LoopOptions options = testOptions(Tool::kSmooth);
  options.record_capacity = 1 << 15;
  StoredBench bench(field_, scene_, options);
  for (std::uint64_t i = 0; i < 20000; ++i) {
    // A keeper that falls behind now and then.
    if (i % 16 == 0 && i / 1000 % 3 != 2) bench.near.prefetch();
    bench.device.input.tool = static_cast<Tool>(i / 500 % kTools);
    bench.tickAt(sweep(i, kStoredSide - 1.0, 0.1, 0.8));
  }
  bench.loop.stop();
  EXPECT_GT(bench.loop.state().not_prefetched, 100U);
  EXPECT_LT(bench.loop.state().not_prefetched, 15000U);
  std::vector<StrokeSample> strokes;
  for (TickRecord record; bench.channels.records.pop(record);) strokes.push_back(record.input);
  ASSERT_EQ(strokes.size(), 20000U);
  engine::JobControl job;
  const auto replayed = replay(field_, field_, strokes, scene_, {}, job);
  ASSERT_TRUE(replayed);
  EXPECT_EQ(engine::contentHash(bench.loop.scene().field.snapshot()), engine::contentHash(replayed->field));
  EXPECT_GT(replayed->report.samples_changed, 1000);
}

}  // namespace
}  // namespace fettle::haptic
