// Pages of a pool and who holds them, without a device.
#include "render/residency/residency.h"

#include <bit>
#include <cstdio>
#include <cstring>
#include <numeric>
#include <random>

#include "engine/field/live_field.h"
#include "engine/marks/change_marks.h"
#include "render/residency/page_table.h"
#include "render/vulkan/descriptor_writes.h"
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

TEST(PageSlots, TheLongestUnusedPageGoesAndOneOfThisFrameNever) {
  PageSlots slots(3);
  std::vector<std::uint32_t> e(6, PageSlots::kNone);
  for (std::size_t i = 0; i < 3; ++i) ASSERT_TRUE(slots.take(&e[i], PageSlots::Hold::kEvictable, i + 1));
  slots.use(e[0], 4);
  ASSERT_TRUE(slots.take(&e[3], PageSlots::Hold::kEvictable, 4));
  EXPECT_EQ(e[1], PageSlots::kNone);
  EXPECT_NE(e[0], PageSlots::kNone);
  slots.use(e[2], 4);
  EXPECT_FALSE(slots.take(&e[4], PageSlots::Hold::kEvictable, 4));
  EXPECT_EQ(slots.used(), 3U);
  EXPECT_EQ(slots.evicted(), 1);
  // A released slot is the first to be taken; one held permanently is never evicted.
  slots.release(&e[3]);
  ASSERT_TRUE(slots.take(&e[4], PageSlots::Hold::kFixed, 4));
  EXPECT_EQ(slots.fixed(), 1U);
  ASSERT_TRUE(slots.take(&e[5], PageSlots::Hold::kEvictable, 5));
  ASSERT_TRUE(slots.take(&e[1], PageSlots::Hold::kEvictable, 6));
  EXPECT_NE(e[4], PageSlots::kNone);
  slots.release(&e[4]);
  EXPECT_EQ(slots.fixed(), 0U);
}

TEST(PageSlots, MoreSlotsAreTakenBeforeAPageGoes) {
  PageSlots slots(2);
  std::vector<std::uint32_t> e(5, PageSlots::kNone);
  ASSERT_TRUE(slots.take(&e[0], PageSlots::Hold::kEvictable, 1));
  ASSERT_TRUE(slots.take(&e[1], PageSlots::Hold::kFixed, 1));
  slots.grow(2);
  EXPECT_EQ(slots.count(), 4U);
  EXPECT_EQ(slots.used(), 2U);
  ASSERT_TRUE(slots.take(&e[2], PageSlots::Hold::kEvictable, 2));
  ASSERT_TRUE(slots.take(&e[3], PageSlots::Hold::kEvictable, 2));
  EXPECT_EQ(slots.evicted(), 0);
  EXPECT_EQ(e[0], 0U);
  EXPECT_EQ(e[1], 1U);
  ASSERT_TRUE(slots.take(&e[4], PageSlots::Hold::kEvictable, 3));
  EXPECT_EQ(e[0], PageSlots::kNone);
  EXPECT_EQ(slots.evicted(), 1);
}

TEST(PageSlots, EqualPagesShareASlotUntilItIsForgottenOrGoes) {
  PageSlots slots(2);
  std::vector<std::uint32_t> e(4, PageSlots::kNone);
  int tile = 0, other = 0;
  const PageGrid::Key key{&tile}, none{};
  ASSERT_TRUE(slots.take(&e[0], PageSlots::Hold::kEvictable, 1));
  slots.name(e[0], 7, key);
  ASSERT_TRUE(slots.share(&e[1], PageSlots::Hold::kEvictable, 7, key, 1));
  EXPECT_EQ(e[0], e[1]);
  EXPECT_EQ(slots.holders(e[0]), 2U);
  EXPECT_FALSE(slots.share(&e[2], PageSlots::Hold::kEvictable, 8, key, 1));
  EXPECT_FALSE(slots.share(&e[2], PageSlots::Hold::kEvictable, 7, {&other}, 1));
  slots.clearName(e[0]);
  EXPECT_FALSE(slots.share(&e[2], PageSlots::Hold::kEvictable, 7, key, 1));
  slots.name(e[0], 7, none);
  EXPECT_FALSE(slots.named(e[0]));
  slots.name(e[0], 7, key);
  ASSERT_TRUE(slots.take(&e[2], PageSlots::Hold::kEvictable, 2));
  ASSERT_TRUE(slots.take(&e[3], PageSlots::Hold::kEvictable, 2));
  EXPECT_EQ(e[0], PageSlots::kNone);
  EXPECT_EQ(e[1], PageSlots::kNone);
  EXPECT_FALSE(slots.share(&e[0], PageSlots::Hold::kEvictable, 7, key, 3));
}

TEST(PageGrid, EveryEntryHasOnePlaceAndKeysFollowWhatChanged) {
  const PageGrid grid(kWidth, kHeight, 6);
  EXPECT_EQ(grid.samples(1), glm::ivec2(375, 275));
  EXPECT_EQ(grid.pages(0), glm::ivec2(24, 18));
  for (int entry = 0; entry < grid.entries(); ++entry) {
    const PageGrid::Place p = grid.place(entry);
    if (p.level < kDataLevels) {
      ASSERT_EQ(grid.entry(p.level, p.page), entry);
      ASSERT_TRUE(p.page.x < grid.pages(p.level).x && p.page.y < grid.pages(p.level).y);
    }
  }
  EXPECT_GE(grid.rimRow(), kHeight);
  const engine::Version before = largeField();
  engine::LiveField live(before, engine::Growth::kAllowed);
  ASSERT_TRUE(live.setHeight(700, 300, 5.0F));
  const engine::Version after = live.snapshot();
  int changed = 0;
  for (const int log2_side : {6, 7, 8}) {
    const PageGrid pages(kWidth, kHeight, log2_side);
    for (int entry = 0; entry < pages.first(kDataLevels); ++entry) {
      const PageGrid::Place p = pages.place(entry);
      const int side = 1 << (log2_side + dataShift(p.level));
      const bool holds = 700 / side == p.page.x && 300 / side == p.page.y;
      ASSERT_EQ(pages.key(entry, before.reader()) != pages.key(entry, after.reader()), holds) << entry;
      changed += holds;
    }
  }
  EXPECT_EQ(changed, 3 * kDataLevels);
}

TEST(PagePool, ShapesStayWithinBudgetAndLimits) {
  for (const std::uint64_t budget :
       {std::uint64_t{0}, std::uint64_t{16384}, std::uint64_t{1500000}, std::uint64_t{64} << 20U,
        std::uint64_t{3} << 30U, std::uint64_t{40} << 30U})
    for (const std::uint32_t max_side : {64U, 128U, 4096U, 16384U})
      for (const std::uint64_t most : {std::uint64_t{2} << 30U, std::uint64_t{1} << 40U}) {
        const PoolShape s = choosePool(budget, 4, max_side, 2048, most);
        const std::uint64_t bytes = std::uint64_t{s.pages()} << (2 * s.log2_side) << 2U;
        SCOPED_TRACE(testing::Message() << budget << ' ' << max_side << ' ' << most);
        EXPECT_LE(bytes, budget);
        EXPECT_LE(bytes, most);
        EXPECT_LE(s.layers, 2048U);
        EXPECT_LE(s.across << s.log2_side, max_side);
        EXPECT_LE(s.across, 128U);
        EXPECT_TRUE(std::has_single_bit(s.across));
        // Nothing much is left over, unless a limit of the device is why.
        if (s.layers < 2048 && budget >= 1500000) {
          EXPECT_GE(static_cast<double>(bytes), 0.8 * static_cast<double>(std::min(budget, most)));
        }
      }
}

// A driver reads the second byte of their size as a number of levels: one that is zero is another image to it.
TEST(PagePool, TexelsOfPagesHaveASizeThatIsOneKindToDrivers) {
  std::vector<std::uint32_t> pages(70000);
  std::iota(pages.begin(), pages.end(), 1U);
  for (const std::size_t count : {0, 1, 8, 63, 64, 65, 1711, 16383, 16384, 16400, 70000}) {
    Packing packing;
    const auto [first, bytes] = packing.addTexels(std::span(pages).first(count));
    const auto [next, some] = packing.add<std::uint32_t>(std::span(pages).first(3));
    SCOPED_TRACE(count);
    EXPECT_NE(bytes >> 8U & 0xffU, 0U);
    EXPECT_GE(bytes, count * sizeof(std::uint32_t));
    EXPECT_LE(bytes, count * sizeof(std::uint32_t) + 256);
    EXPECT_GE(next, first + bytes);
    std::vector<std::byte> out(packing.bytes());
    packing.write(out.data());
    EXPECT_EQ(std::memcmp(out.data() + first, pages.data(), count * sizeof(std::uint32_t)), 0);
    EXPECT_EQ(std::memcmp(out.data() + next, pages.data(), some), 0);
  }
}

}  // namespace
}  // namespace fettle::render
