// A field in a mapped file is the same field: same bits, same edits, and refusals instead of signals.
#include "engine/field/tile_store.h"

#include <csignal>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "engine/field/builder.h"
#include "engine/field/live_field.h"
#include "engine/filter/filter.h"
#include "tests/support/mapped_pages.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

constexpr std::int32_t kWidth = 1500;
constexpr std::int32_t kHeight = 1100;

std::vector<float> heights() {
  std::vector<float> z(static_cast<std::size_t>(kWidth) * kHeight);
  std::uint32_t state = 12345;
  for (float& v : z) {
    state = state * 1664525U + 1013904223U;
    v = static_cast<float>(state >> 8) * 0x1p-20F;
  }
  return z;
}

Grid gridOf() {
  Grid grid;
  grid.width = kWidth;
  grid.height = kHeight;
  return grid;
}

class TileStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto store = TileStore::create(folder_.path().string(), 0); !store)
      GTEST_SKIP() << store.error().line();
  }
  void TearDown() override { setStorePolicy({}); }
  void storeAll() { setStorePolicy({.folder = folder_.path().string(), .always = true}); }

  fettle::tests::TempFolder folder_;
};

TEST_F(TileStoreTest, AStoredFieldHasTheSameBitsThroughEditFilterAndUndo) {
  const auto way = [](std::uint64_t(&hashes)[4]) {
    const Version start = makeField(gridOf(), heights());
    hashes[0] = contentHash(start);
    LiveField live(start, Growth::kAllowed);
    for (int i = 0; i < 3000; ++i) (void)live.setHeight(i % kWidth, i * 7 % kHeight, static_cast<float>(i));
    const Version edited = live.snapshot();
    hashes[1] = contentHash(edited);
    FilterSpec spec;
    spec.kind = FilterKind::kMedian;
    JobControl job;
    auto filtered = applyFilter(edited, start, spec, job);
    ASSERT_TRUE(filtered);
    hashes[2] = contentHash(filtered->field);
    (void)live.adopt(filtered->field);
    (void)live.adopt(start);
    hashes[3] = contentHash(live.snapshot());
  };
  std::uint64_t plain[4]{}, stored[4]{};
  way(plain);
  storeAll();
  way(stored);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(stored[i], plain[i]) << i;
  EXPECT_EQ(plain[0], plain[3]);
}

TEST_F(TileStoreTest, WholeFieldsLieInTheStoreAndWhatTheLoopWritesDoesNot) {
  storeAll();
  const Version start = makeField(gridOf(), heights());
  const std::unique_ptr<TileStore>& store = start.memory()->store;
  ASSERT_TRUE(store);
  EXPECT_GE(store->bytes(), fieldBytes(kWidth, kHeight));
  const FieldReader reader = start.reader();
  for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < reader.tileColumns(); ++tc)
      ASSERT_TRUE(store->holds(&reader.tile(tc, tr))) << tc << " " << tr;
  EXPECT_FALSE(store->holds(&reader.root()));
  EXPECT_FALSE(store->holds(&start));

  ASSERT_TRUE(start.memory()->tiles.reserve(8) && start.memory()->nodes.reserve(8));
  LiveField loop(start, Growth::kNever);
  ASSERT_TRUE(loop.setHeight(700, 700, 3.0F));
  EXPECT_FALSE(store->holds(&loop.reader().tile(700 / kTileSide, 700 / kTileSide)));
  LiveField job(start, Growth::kAllowed);
  ASSERT_TRUE(job.setHeight(700, 700, 3.0F));
  EXPECT_TRUE(store->holds(&job.reader().tile(700 / kTileSide, 700 / kTileSide)));
}

TEST_F(TileStoreTest, CountersOfTilesOnTheDiskAreInMemory) {
  storeAll();
  Version start = makeField(gridOf(), heights());
  const std::uint64_t hash = contentHash(start);
  const FieldReader reader = start.reader();
  for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < reader.tileColumns(); ++tc)
      if (!fettle::tests::Pages(&reader.tile(tc, tr)).sendOut()) GTEST_SKIP() << "pages cannot be sent out";
  const auto faults = [] {
    rusage usage{};
    getrusage(RUSAGE_THREAD, &usage);
    return usage.ru_majflt;
  };
  const auto before = faults();
  {
    std::vector<TileRef> held;
    for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr)
      for (std::int32_t tc = 0; tc < reader.tileColumns(); ++tc)
        held.push_back(TileRef::share(&reader.tile(tc, tr)));
    EXPECT_GT(reader.bounds().max, reader.bounds().min);
  }
  EXPECT_EQ(faults(), before);
  // While the samples themselves do come from the disk.
  EXPECT_EQ(contentHash(start), hash);
  EXPECT_GT(faults(), before);
  start = {};
}

TEST_F(TileStoreTest, ADiskThatFillsUpIsAnErrorNotASignal) {
  storeAll();
  // No file may grow past 4 MB: what a full disk says, without filling one.
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit small = before;
  small.rlim_cur = 4U << 20;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto builder = FieldBuilder::create(gridOf(), "scan");
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(builder);
  EXPECT_EQ(builder.error().kind, ErrorKind::kFailed);
}

TEST_F(TileStoreTest, TakesMoreOfTheDiskOnlyWhenAllIsUsed) {
  const auto store = TileStore::create(folder_.path().string(), 0);
  ASSERT_TRUE(store);
  EXPECT_EQ((*store)->bytes(), 0U);
  constexpr std::size_t kSlab = std::size_t{16} << 20;
  const auto take = [&] { ASSERT_NE((*store)->take(kSlab), nullptr); };
  take();
  const std::uint64_t at_once = (*store)->bytes();
  ASSERT_GE(at_once, 2 * kSlab);  // room for more slabs, in one piece
  ASSERT_EQ(at_once % kSlab, 0U);
  for (std::uint64_t used = kSlab; used < at_once; used += kSlab) take();
  EXPECT_EQ((*store)->bytes(), at_once);
  take();
  EXPECT_EQ((*store)->bytes(), 2 * at_once);
}

TEST_F(TileStoreTest, FoldersThatCannotHoldTilesAreRefused) {
  EXPECT_FALSE(TileStore::create(folder_.file("none"), 0));
  const auto huge = TileStore::create(folder_.path().string(), std::uint64_t{1} << 60);
  ASSERT_FALSE(huge);
  EXPECT_EQ(huge.error().kind, ErrorKind::kInput);
  // Always in memory on Linux.
  const auto in_memory = TileStore::create("/dev/shm", 0);
  ASSERT_FALSE(in_memory);
  EXPECT_EQ(in_memory.error().kind, ErrorKind::kInput);
}

TEST_F(TileStoreTest, ThePolicySaysWhatLiesWhere) {
  StorePolicy policy;
  policy.folder = folder_.path().string();
  policy.share = 1.0;
  setStorePolicy(policy);
  EXPECT_EQ(placeOf(2000, 2000, 0, "scan").value(), Place::kMemory);
  policy.share = 0.0;
  setStorePolicy(policy);
  EXPECT_EQ(placeOf(2000, 2000, 0, "scan").value(), Place::kStore);
  // 294 GB, and more in addition than any machine has.
  const auto nowhere = placeOf(262144, 262144, std::uint64_t{1} << 60, "scan");
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().kind, ErrorKind::kInput);
  EXPECT_EQ(nowhere.error().where, "scan");
  // Sizes at which 32 bits are not enough.
  EXPECT_GT(fieldBytes(32768, 32768), std::uint64_t{4} << 30);
  EXPECT_GT(fieldBytes(65536, 65536), std::uint64_t{16} << 30);
}

}  // namespace
}  // namespace fettle::engine
