// Fields of which the device holds a part: which one, and that the picture says and shows what it should.
#include "render/residency.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "engine/field/live_field.h"
#include "render/live_picture.h"
#include "render/page_table.h"
#include "tests/render/fields.h"

namespace fettle::render {
namespace {

double hash01(int c, int r) {
  std::uint32_t h = static_cast<std::uint32_t>(c) * 2654435761U ^ static_cast<std::uint32_t>(r) * 2246822519U;
  h ^= h >> 15U;
  h *= 2246822519U;
  return (h >> 8U) / 16777216.0;
}

// Slopes, walls, a dome, noise.
double part(int c, int r) {
  const double x = c * 0.05, y = r * 0.05;
  double z = 0.03 * x + 0.01 * hash01(c, r);
  if (std::hypot(x - 20, y - 30) < 9) z += 5;
  if (y > 8 && y < 12) z -= 3;
  const double dome = std::hypot(x - 50, y - 25);
  if (dome < 12) z += std::sqrt(144 - dome * dome) * 0.5;
  return z;
}

constexpr int kWidth = 1500, kHeight = 1100;

engine::Version partField() {
  return fieldOf(gridOf(kWidth, kHeight, 0.05, 0.05), part,
                 [](int c, int r) { return (c + 2 * r) % 190 < 5; });
}
// A hole in places, also on the last column and row.
engine::Version holedField() {
  return fieldOf(gridOf(kWidth, kHeight, 0.05, 0.05), [](int c, int r) {
    const bool gap = std::hypot(c - 700.0, r - 500.0) < 40 || (c > 1400 && r % 300 < 60) ||
                     (r > 1080 && c % 400 < 33) || hash01(c, r) > 0.9995;
    return gap ? double{kNan} : part(c, r);
  });
}

struct Options {
  std::int64_t budget = 0;
  std::int64_t bytes_a_frame = std::int64_t{6} << 20;
  int max_side = 0;
};

std::unique_ptr<LivePicture> makePicture(const Options& wanted = {}) {
  LiveOptions options;
  options.validation = Validation::kOn;
  options.memory_budget_bytes = wanted.budget;
  options.upload_bytes_a_frame = wanted.bytes_a_frame;
  options.max_image_side = wanted.max_side;
  auto picture = LivePicture::create(options);
  if (!picture) ADD_FAILURE() << picture.error().line();
  return picture ? *std::move(picture) : nullptr;
}

FrameInput bare(double zoom, double x = 0.5, double y = 0.5) {
  FrameInput input;
  input.view.width = 360;
  input.view.height = 240;
  input.view.zoom = zoom;
  input.view.centre_x = x;
  input.view.centre_y = y;
  input.view.vertical_exaggeration = 1.0;
  input.decoration = Decoration::kNone;
  input.range = ValueRange{-3, 9};
  return input;
}

struct Frame {
  Image image;
  FrameStatistics stats;
};

Frame shoot(LivePicture& picture, const FrameInput& input) {
  Frame frame;
  const auto stats = picture.draw(input, frame.image);
  if (!stats) {
    ADD_FAILURE() << stats.error().line();
    return frame;
  }
  for (const std::string& message : picture.validationMessages()) ADD_FAILURE() << message;
  frame.stats = *stats;
  return frame;
}

// Frames until nothing is on its way any more; the last of them.
Frame settle(LivePicture& picture, const FrameInput& input, int* frames = nullptr) {
  for (int n = 1; n < 500; ++n) {
    Frame frame = shoot(picture, input);
    if (frames != nullptr) *frames = n;
    if (frame.stats.upload.pending_tiles == 0 && frame.stats.residency.pages_loaded == 0) return frame;
  }
  ADD_FAILURE() << "pages keep coming";
  return {};
}

std::size_t differing(const Image& a, const Image& b) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4)
    n += !std::equal(a.rgba.begin() + static_cast<std::ptrdiff_t>(i),
                     a.rgba.begin() + static_cast<std::ptrdiff_t>(i) + 4,
                     b.rgba.begin() + static_cast<std::ptrdiff_t>(i));
  return n;
}

TEST(PageSlots, TheLongestUnusedPageGoesAndOneOfThisFrameNever) {
  PageSlots slots(3);
  std::vector<std::uint32_t> e(6, PageSlots::kNone);
  for (std::size_t i = 0; i < 3; ++i) ASSERT_TRUE(slots.take(&e[i], PageSlots::Hold::kWhile, i + 1));
  slots.use(e[0], 4);
  ASSERT_TRUE(slots.take(&e[3], PageSlots::Hold::kWhile, 4));
  EXPECT_EQ(e[1], PageSlots::kNone);
  EXPECT_NE(e[0], PageSlots::kNone);
  slots.use(e[2], 4);
  EXPECT_FALSE(slots.take(&e[4], PageSlots::Hold::kWhile, 4));
  EXPECT_EQ(slots.used(), 3U);
  EXPECT_EQ(slots.evicted(), 1);
  // A released slot is the first to be taken; one held for good never goes.
  slots.release(&e[3]);
  ASSERT_TRUE(slots.take(&e[4], PageSlots::Hold::kFixed, 4));
  EXPECT_EQ(slots.fixed(), 1U);
  ASSERT_TRUE(slots.take(&e[5], PageSlots::Hold::kWhile, 5));
  ASSERT_TRUE(slots.take(&e[1], PageSlots::Hold::kWhile, 6));
  EXPECT_NE(e[4], PageSlots::kNone);
  slots.release(&e[4]);
  EXPECT_EQ(slots.fixed(), 0U);
}

TEST(PageSlots, EqualPagesShareASlotUntilItIsForgottenOrGoes) {
  PageSlots slots(2);
  std::vector<std::uint32_t> e(4, PageSlots::kNone);
  int tile = 0, other = 0;
  const PageGrid::Key key{&tile}, none{};
  ASSERT_TRUE(slots.take(&e[0], PageSlots::Hold::kWhile, 1));
  slots.name(e[0], 7, key);
  ASSERT_TRUE(slots.share(&e[1], PageSlots::Hold::kWhile, 7, key, 1));
  EXPECT_EQ(e[0], e[1]);
  EXPECT_EQ(slots.holders(e[0]), 2U);
  EXPECT_FALSE(slots.share(&e[2], PageSlots::Hold::kWhile, 8, key, 1));
  EXPECT_FALSE(slots.share(&e[2], PageSlots::Hold::kWhile, 7, {&other}, 1));
  slots.forget(e[0]);
  EXPECT_FALSE(slots.share(&e[2], PageSlots::Hold::kWhile, 7, key, 1));
  slots.name(e[0], 7, none);
  EXPECT_FALSE(slots.named(e[0]));
  slots.name(e[0], 7, key);
  ASSERT_TRUE(slots.take(&e[2], PageSlots::Hold::kWhile, 2));
  ASSERT_TRUE(slots.take(&e[3], PageSlots::Hold::kWhile, 2));
  EXPECT_EQ(e[0], PageSlots::kNone);
  EXPECT_EQ(e[1], PageSlots::kNone);
  EXPECT_FALSE(slots.share(&e[0], PageSlots::Hold::kWhile, 7, key, 3));
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
  const engine::Version before = partField();
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
        EXPECT_LE(s.across, 255U);
        // Nothing much is left over, unless a limit of the device is why.
        if (s.layers < 2048 && budget >= 1500000) {
          EXPECT_GE(static_cast<double>(bytes), 0.8 * static_cast<double>(std::min(budget, most)));
        }
      }
}

TEST(Residency, AFieldThatFitsIsThereAsAWhole) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(partField()));
  EXPECT_FALSE(shoot(*picture, bare(1)).stats.residency.by_need);
}

TEST(Residency, ATightBudgetEndsInTheSamePictureBitForBitOverViewsAndEdits) {
  std::mt19937 random(5);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * std::generate_canonical<double, 32>(random);
  };
  for (const bool holed : {false, true}) {
    SCOPED_TRACE(holed ? "with holes" : "without holes");
    // All of it would take 7 MB of heights, 1.8 MB of marks.
    const std::int64_t budget = 2900000;
    auto tight = makePicture({.budget = budget, .bytes_a_frame = 300000}), whole = makePicture();
    Shown shown;
    const engine::Version first = holed ? holedField() : partField();
    shown.versions = {first};
    shown.marks = holed ? MarksOverlay::kHide : MarksOverlay::kShow;
    engine::LiveField live(first, engine::Growth::kAllowed);
    ASSERT_TRUE(tight->update(shown));
    ASSERT_TRUE(whole->update(shown));
    std::int64_t loaded = 0, gone_coarse = 0;
    for (int round = 0; round < 14; ++round) {
      SCOPED_TRACE(round);
      FrameInput input = bare(uniform(4, 30), uniform(0, 1), uniform(0, 1));
      if (round % 5 == 4) input.view.centre_x = input.view.centre_y = 1.0;  // the last column and row
      input.view.azimuth_deg = uniform(0, 360);
      input.view.elevation_deg = uniform(35, 90);
      if (round % 3 == 1) input.view.projection = Projection::kPerspective;
      if (round % 4 == 2) input.contours = Contours::kShow;
      // A stroke near the middle of the view, one anywhere, and now and then a step back.
      const auto stroke = [&](double x, double y) {
        std::vector<float> z(50 * 30);
        for (float& v : z) v = static_cast<float>(uniform(-1, 6));
        const int c = std::clamp(static_cast<int>(x * kWidth), 0, kWidth - 50);
        const int r = std::clamp(static_cast<int>(y * kHeight), 0, kHeight - 30);
        ASSERT_TRUE(live.writeHeights(c, r, 50, 30, z.data(), 50));
        ASSERT_TRUE(live.setMark(c, r, round % 2 == 0));
      };
      stroke(input.view.centre_x, input.view.centre_y);
      stroke(uniform(0, 1), uniform(0, 1));
      shown.versions = {round % 6 == 5 ? first : live.snapshot()};
      ASSERT_TRUE(tight->update(shown));
      ASSERT_TRUE(whole->update(shown));
      Frame frame;
      do {
        frame = shoot(*tight, input);
        const ResidencyStatistics& r = frame.stats.residency;
        ASSERT_TRUE(r.by_need);
        ASSERT_LE(r.device_bytes, budget);
        ASSERT_LE(r.pages_used, r.pages);
        // Never more than is allowed, or one tile (and its pages) or page where that is larger.
        ASSERT_LE(frame.stats.upload.bytes, 300000 + 6 * 20480);
        loaded += r.pages_loaded;
        gone_coarse += frame.stats.bound_px > 1.0;
      } while (frame.stats.residency.pages_loaded > 0 || frame.stats.upload.pending_tiles > 0);
      ASSERT_EQ(frame.stats.residency.pages_beyond, 0) << frame.stats.residency.pages_asked;
      const Frame expected = settle(*whole, input);
      EXPECT_FALSE(expected.stats.residency.by_need);
      EXPECT_EQ(frame.stats.bound_px, expected.stats.bound_px);
      EXPECT_EQ(frame.stats.vertices, expected.stats.vertices);
      EXPECT_EQ(differing(frame.image, expected.image), 0U);
    }
    EXPECT_GT(loaded, 100);
    EXPECT_GT(gone_coarse, 3);
  }
}

}  // namespace
}  // namespace fettle::render
