// Fields of which the device holds a part: which one, and that the picture says and shows what it should.
#include "render/residency/residency.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "engine/field/live_field.h"
#include "engine/marks/change_marks.h"
#include "render/live/live_picture.h"
#include "render/residency/page_table.h"
#include "tests/render/support/fields.h"

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

TEST(PageSlots, MoreSlotsAreTakenBeforeAPageGoes) {
  PageSlots slots(2);
  std::vector<std::uint32_t> e(5, PageSlots::kNone);
  ASSERT_TRUE(slots.take(&e[0], PageSlots::Hold::kWhile, 1));
  ASSERT_TRUE(slots.take(&e[1], PageSlots::Hold::kFixed, 1));
  slots.grow(2);
  EXPECT_EQ(slots.count(), 4U);
  EXPECT_EQ(slots.used(), 2U);
  ASSERT_TRUE(slots.take(&e[2], PageSlots::Hold::kWhile, 2));
  ASSERT_TRUE(slots.take(&e[3], PageSlots::Hold::kWhile, 2));
  EXPECT_EQ(slots.evicted(), 0);
  EXPECT_EQ(e[0], 0U);
  EXPECT_EQ(e[1], 1U);
  ASSERT_TRUE(slots.take(&e[4], PageSlots::Hold::kWhile, 3));
  EXPECT_EQ(e[0], PageSlots::kNone);
  EXPECT_EQ(slots.evicted(), 1);
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

// Large for a picture, in little memory: a wave, and a step of its own in every tile.
engine::Version wideField(double lift) {
  return fieldOf(gridOf(2600, 2000, 0.05, 0.05), [&](int c, int r) {
    return lift + std::sin(0.01 * c) * std::cos(0.013 * r) + 0.05 * (((c >> 6) + (r >> 6)) & 3);
  });
}

TEST(Residency, TheFirstPictureOfALargeFieldWaitsForACoarseCopyAlone) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(wideField(0.0)));
  const Frame first = shoot(*picture, bare(1));
  EXPECT_TRUE(first.stats.residency.by_need);
  // 20.8 MB of samples; every 4th each way before the first picture, and then what it asks for.
  EXPECT_LT(first.stats.upload.bytes, (std::int64_t{8} << 20) + (std::int64_t{6} << 20));
  EXPECT_LT(first.stats.residency.device_bytes, std::int64_t{64} << 20);
}

TEST(Residency, AResultThatChangesEveryTileComesOverWithoutLookingForRectangles) {
  const engine::Version before = wideField(0.0);
  // The same memory, so that it is a state of the same field.
  engine::LiveField live(before, engine::Growth::kAllowed);
  std::vector<float> row(2600);
  for (int r = 0; r < 2000; ++r) {
    before.reader().readHeights(0, r, 2600, 1, row.data(), 2600);
    for (float& z : row) z += 0.25F * static_cast<float>((r >> 5) & 1);
    // One band of tiles stays as it is, copied all the same.
    if (r < 640 || r >= 704) {
      ASSERT_TRUE(live.writeHeights(0, r, 2600, 1, row.data(), 2600));
    }
  }
  ASSERT_TRUE(live.setMark(100, 650, true));
  const engine::Version after = live.snapshot();
  auto stays = makePicture(), fresh = makePicture();
  for (const double zoom : {1.0, 14.0}) {
    SCOPED_TRACE(zoom);
    const FrameInput input = bare(zoom, 0.4, 0.3);
    ASSERT_TRUE(stays->update(before));
    const Frame old = settle(*stays, input);
    ASSERT_TRUE(stays->update(after));
    ASSERT_TRUE(fresh->update(after));
    stays->refreshRanges();
    const Frame a = settle(*stays, input), b = settle(*fresh, input);
    EXPECT_TRUE(a.stats.residency.by_need);
    EXPECT_EQ(differing(a.image, b.image), 0U);
    EXPECT_GT(differing(a.image, old.image), 5000U);
  }
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
    for (int round = 0; round < 9; ++round) {
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
    EXPECT_GT(loaded, 80);
    EXPECT_GT(gone_coarse, 3);
  }
}

// Pixels of `a` that no pixel of `b` within `radius` equals within `codes` in every channel.
int unmatched(const Image& a, const Image& b, int radius, int codes) {
  int off = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      bool found = false;
      for (int v = std::max(0, y - radius); v <= std::min(a.height - 1, y + radius) && !found; ++v)
        for (int u = std::max(0, x - radius); u <= std::min(a.width - 1, x + radius) && !found; ++u) {
          int worst = 0;
          for (int k = 0; k < 3; ++k)
            worst = std::max(worst, std::abs(pixel(a, x, y)[k] - pixel(b, u, v)[k]));
          found = worst <= codes;
        }
      off += !found;
    }
  return off;
}

TEST(Residency, TheBoundHoldsWhilePagesAreMissingAndShrinksAsTheyCome) {
  // Without noise: it would show in the light on coarse samples, which is not what the bound speaks of.
  const engine::Version field = fieldOf(gridOf(kWidth, kHeight, 0.05, 0.05), [](int c, int r) {
    const double x = c * 0.05, y = r * 0.05;
    return 0.03 * x + 2.0 * std::sin(0.35 * x) * std::cos(0.3 * y) + (y > 8 && y < 12 ? -3.0 : 0.0);
  });
  // Two pages a frame.
  auto tight = makePicture({.budget = 2900000, .bytes_a_frame = 2 * 16384}), whole = makePicture();
  ASSERT_TRUE(tight->update(field));
  ASSERT_TRUE(whole->update(field));
  int with_missing = 0;
  for (const auto& [zoom, x, y, elevation] :
       {std::tuple{6.0, 0.3, 0.2, 40.0}, {8.0, 0.8, 0.7, 25.0}, {5.0, 0.5, 0.5, 90.0}}) {
    FrameInput input = bare(zoom, x, y);
    input.view.elevation_deg = elevation;
    input.view.width = 240;
    input.view.height = 160;
    FrameInput full = input;
    full.error_px = 1e-9;
    full.vertex_budget = 1 << 24;
    const Frame fine = settle(*whole, full);
    ASSERT_LE(fine.stats.bound_px, 1e-9);
    double least = 1e9;
    for (int frame = 0; frame < 60; ++frame) {
      const Frame coarse = shoot(*tight, input);
      if (coarse.stats.residency.pages_waiting == 0) break;
      EXPECT_GE(coarse.stats.residency.pages_loaded, 1);
      // The first frame tells of the coarse copies as well, that came with update().
      if (frame > 0) {
        EXPECT_LE(coarse.stats.upload.bytes, 2 * 16384);
      }
      EXPECT_GT(coarse.stats.upload.pending_tiles, 0);
      least = std::min(least, coarse.stats.bound_px);
      const int radius = static_cast<int>(std::ceil(coarse.stats.bound_px)) + 1;
      if (frame % 3 != 0 || radius > 20) continue;
      with_missing += coarse.stats.bound_px > 1.0;
      // As for coarse strides in live_test.cpp: along edges a few pixels have no partner.
      const int pixels = coarse.image.width * coarse.image.height;
      EXPECT_LE(unmatched(coarse.image, fine.image, radius, 10), pixels / 500) << coarse.stats.bound_px;
      EXPECT_LE(unmatched(fine.image, coarse.image, radius, 10), pixels / 500) << coarse.stats.bound_px;
    }
    const Frame done = settle(*tight, input);
    EXPECT_EQ(done.stats.bound_px, settle(*whole, input).stats.bound_px);
    EXPECT_LE(done.stats.bound_px, least);
  }
  EXPECT_GT(with_missing, 5);
}

TEST(Residency, AViewOfMoreThanTheBudgetComesToRestAndSaysWhatItShows) {
  auto tight = makePicture({.budget = 450000});
  ASSERT_TRUE(tight->update(partField()));
  FrameInput input = bare(1);
  input.view.elevation_deg = 60;
  Frame rest = settle(*tight, input);
  EXPECT_GT(rest.stats.residency.pages_beyond, 0);
  EXPECT_LE(rest.stats.residency.device_bytes, 450000);
  EXPECT_GT(rest.stats.bound_px, 1.0);
  // At rest: nothing is brought any more, and the picture stays as it is.
  for (int i = 0; i < 3; ++i) {
    const Frame again = shoot(*tight, input);
    EXPECT_EQ(again.stats.residency.pages_loaded, 0);
    EXPECT_EQ(again.stats.upload.bytes, 0);
    EXPECT_EQ(again.image.rgba, rest.image.rgba);
  }
}

TEST(Residency, AFieldLargerThanTheDevicesImagesIsDrawnFromPages) {
  // 63 samples more than one image of the forced limit would hold each way, many times over.
  const engine::Version field = fieldOf(gridOf(6000, 190, 0.05, 0.05), part);
  auto tight = makePicture({.budget = 2900000, .max_side = 64}), whole = makePicture();
  ASSERT_TRUE(tight->update(field));
  ASSERT_TRUE(whole->update(field));
  for (const double x : {0.0, 0.31, 0.77, 1.0}) {
    FrameInput input = bare(12, x, 0.5);
    const Frame a = settle(*tight, input), b = settle(*whole, input);
    EXPECT_TRUE(a.stats.residency.by_need);
    EXPECT_EQ(a.stats.residency.pages_beyond, 0);
    EXPECT_EQ(differing(a.image, b.image), 0U) << x;
  }
}

TEST(Residency, AnEditBesideTheViewCostsItsCoarseCopiesAlone) {
  auto tight = makePicture({.budget = 1500000});
  const engine::Version before = partField();
  ASSERT_TRUE(tight->update(before));
  const FrameInput input = bare(12, 0.2, 0.2);
  (void)settle(*tight, input);
  engine::LiveField live(before, engine::Growth::kAllowed);
  const std::vector<float> z(64 * 64, 7.0F);
  ASSERT_TRUE(live.writeHeights(1280, 960, 64, 64, z.data(), 64));
  ASSERT_TRUE(tight->update(live.snapshot()));
  const Frame far = shoot(*tight, input);
  // Every 16th and 64th sample stay on the device; every 4th comes by need.
  EXPECT_EQ(far.stats.upload.bytes, (16 + 1) * 4);
  EXPECT_EQ(far.stats.upload.pending_tiles, 0);
  const std::vector<float> near(10 * 10, 7.0F);
  ASSERT_TRUE(live.writeHeights(300, 220, 10, 10, near.data(), 10));
  ASSERT_TRUE(tight->update(live.snapshot()));
  EXPECT_GE(shoot(*tight, input).stats.upload.bytes, 10 * 10 * 4);
}

TEST(Residency, PreviewsAndTheOriginalShareEqualPagesAndShowWhatTheyShould) {
  const engine::Version original = partField();
  engine::LiveField live(original, engine::Growth::kAllowed);
  std::vector<float> z(120 * 90);
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = 1.0F + 0.001F * static_cast<float>(i % 97);
  ASSERT_TRUE(live.writeHeights(700, 500, 120, 90, z.data(), 120));
  const engine::Version edited = live.snapshot();
  ASSERT_TRUE(live.writeHeights(760, 560, 100, 30, z.data(), 100));
  const engine::Version preview = live.snapshot();
  auto tight = makePicture({.budget = 3300000}), whole = makePicture();
  Shown shown;
  shown.versions = {edited};
  shown.marks = MarksOverlay::kShow;
  FrameInput input = bare(9);
  const auto compare = [&](const char* what) {
    SCOPED_TRACE(what);
    EXPECT_TRUE(tight->update(shown));
    EXPECT_TRUE(whole->update(shown));
    const Frame a = settle(*tight, input), b = settle(*whole, input);
    EXPECT_EQ(a.stats.residency.pages_beyond, 0);
    EXPECT_EQ(differing(a.image, b.image), 0U);
    return a.stats.residency;
  };
  (void)compare("one version");
  shown.versions = {edited, preview};
  shown.original = original;
  input.range.reset();
  // Three states are looked at, but where they are alike there is one page. (What an earlier view asked for
  // is still there as well.)
  const ResidencyStatistics shared = compare("a preview and the deviation from the original");
  EXPECT_LT(shared.pages_used, shared.pages_asked * 3 / 4);
  // Both go on, apart from each other: what one of them changes is not the other's.
  ASSERT_TRUE(live.writeHeights(690, 530, 60, 60, z.data(), 60));
  shown.versions = {live.snapshot(), edited};
  (void)compare("an edit in pages that were shared");
  shown.versions = {edited, live.snapshot()};
  (void)compare("the other way round");
  shown.versions = {original};
  shown.original.reset();
  input.range = ValueRange{-3, 9};
  (void)compare("back to one");
}

// States of one field of which no two have a tile in common, as filters make them of every sample.
std::vector<engine::Version> statesOf(const engine::Version& field, std::size_t count) {
  const int width = field.grid().width, height = field.grid().height;
  std::vector<engine::Version> states{field};
  std::vector<float> row(static_cast<std::size_t>(width));
  for (std::size_t i = 1; i < count; ++i) {
    engine::LiveField live(field, engine::Growth::kAllowed);
    for (int r = 0; r < height; ++r) {
      field.reader().readHeights(0, r, width, 1, row.data(), width);
      for (float& z : row) z *= 1.0F + 0.01F * static_cast<float>(i);
      if (!live.writeHeights(0, r, width, 1, row.data(), width)) ADD_FAILURE() << "no memory";
    }
    states.push_back(live.snapshot());
  }
  return states;
}

TEST(Residency, FourStatesSideBySideComeAsNearAsASinglePicture) {
  // Of a million samples, marks shown, three such states are there as a whole and four by need.
  const engine::Version field =
      fieldOf(gridOf(1000, 850, 0.05, 0.05), part, [](int c, int r) { return (c + 2 * r) % 190 < 5; });
  auto picture = makePicture();
  Shown shown;
  shown.marks = MarksOverlay::kShow;
  shown.versions = {field};
  ASSERT_TRUE(picture->update(shown));
  FrameInput input = bare(1);
  // Four panels whose colours come from every sample: all of each state is asked for.
  input.view.width = 1100;
  input.view.height = 760;
  constexpr std::int64_t kRest = std::int64_t{1} << 20;
  input.panel_vertices = {kRest};
  const Frame one = settle(*picture, input);
  ASSERT_EQ(one.stats.panels.size(), 1U);
  EXPECT_LE(one.stats.panels[0].bound_px, 1.0);
  const std::vector<engine::Version> states = statesOf(field, 5);
  for (const std::size_t count : {4U, 5U}) {
    SCOPED_TRACE(count);
    shown.versions.assign(states.begin(), states.begin() + static_cast<std::ptrdiff_t>(count));
    // The last ones with a deviation map: an original is one more. Pages that are there are kept.
    if (count == states.size()) shown.original = field;
    ASSERT_TRUE(picture->update(shown));
    input.panel_vertices.assign(count, kRest);
    const Frame rest = settle(*picture, input);
    EXPECT_TRUE(rest.stats.residency.by_need);
    EXPECT_EQ(rest.stats.residency.pages_beyond, 0);
    ASSERT_EQ(rest.stats.panels.size(), count);
    for (const PanelDetail& panel : rest.stats.panels) {
      EXPECT_LE(panel.bound_px, 1.0);
      EXPECT_EQ(panel.limit, DetailLimit::kNone);
    }
  }
  // As one sees it who opens all of them at once.
  auto other = makePicture();
  ASSERT_TRUE(other->update(shown));
  picture->refreshRanges();
  EXPECT_EQ(differing(settle(*picture, input).image, settle(*other, input).image), 0U);
}

TEST(Residency, WhatDoesNotFitIsSharedOutAmongThePanelsAndTheLimitSaid) {
  // A twelfth of what four states take.
  auto tight = makePicture({.budget = 2'400'000});
  Shown shown;
  shown.versions = statesOf(fieldOf(gridOf(kWidth, kHeight, 0.05, 0.05), part), 4);
  ASSERT_TRUE(tight->update(shown));
  FrameInput input = bare(1);
  input.view.width = 640;
  input.view.height = 400;
  input.error_px = 0.1;
  input.panel_vertices.assign(4, std::int64_t{1} << 20);
  const Frame rest = settle(*tight, input);
  EXPECT_LE(rest.stats.residency.device_bytes, 2'400'000);
  EXPECT_GT(rest.stats.residency.pages_beyond, 0);
  double best = 1e9, worst = 0.0;
  for (const PanelDetail& panel : rest.stats.panels) {
    EXPECT_EQ(panel.limit, DetailLimit::kMemory);
    best = std::min(best, panel.bound_px);
    worst = std::max(worst, panel.bound_px);
  }
  EXPECT_GT(best, 0.1);
  EXPECT_LT(worst, 2.0 * best);
  EXPECT_EQ(rest.stats.bound_px, worst);
  // And of vertices.
  auto whole = makePicture();
  ASSERT_TRUE(whole->update(shown.versions.front()));
  input.panel_vertices.assign(1, 4096);
  const Frame few = settle(*whole, input);
  EXPECT_EQ(few.stats.panels.front().limit, DetailLimit::kVertices);
  // One number a panel, or none.
  Image image;
  input.panel_vertices.assign(2, 4096);
  EXPECT_FALSE(whole->draw(input, image));
  input.panel_vertices.assign(1, 0);
  EXPECT_FALSE(whole->draw(input, image));
}

TEST(Residency, SuggestedMarksHaveAColourOfTheirOwnAndLoseItWhenAccepted) {
  const engine::Version field = partField();
  engine::JobControl job;
  const auto inverted = engine::invertMarks(field, job);
  ASSERT_TRUE(inverted);
  for (const double zoom : {1.0, 9.0}) {
    SCOPED_TRACE(zoom);
    auto tight = makePicture({.budget = 3300000}), whole = makePicture();
    const FrameInput input = bare(zoom);
    // From pages as from a whole, and as if nothing had been shown before.
    const auto seen = [&](const Shown& shown, const char* what) {
      SCOPED_TRACE(what);
      auto fresh = makePicture();
      for (auto* picture : {&tight, &whole, &fresh}) EXPECT_TRUE((*picture)->update(shown));
      const Frame a = settle(*tight, input), b = settle(*whole, input), c = settle(*fresh, input);
      EXPECT_EQ(differing(a.image, b.image), 0U);
      EXPECT_EQ(differing(b.image, c.image), 0U);
      return b.image;
    };
    Shown shown;
    shown.versions = {field};
    shown.marks = MarksOverlay::kShow;
    const Image before = seen(shown, "the marks there are");
    shown.versions = {*inverted};
    shown.accepted = field;
    const Image suggested = seen(shown, "suggested");
    EXPECT_GT(differing(before, suggested), 20000U);
    // The very same version, and no tile of it changes.
    shown.accepted = *inverted;
    const Image taken = seen(shown, "taken");
    EXPECT_GT(differing(suggested, taken), 20000U);
    shown.accepted.reset();
    EXPECT_EQ(differing(seen(shown, "marks like any others"), taken), 0U);
    shown.accepted = field;
    EXPECT_EQ(differing(seen(shown, "suggested again"), suggested), 0U);
    shown.versions = {field};
    shown.accepted.reset();
    EXPECT_EQ(differing(seen(shown, "dropped"), before), 0U);
  }
  // Of another field it says nothing.
  auto picture = makePicture();
  Shown shown;
  shown.versions = {field};
  shown.accepted = partField();
  EXPECT_FALSE(picture->update(shown));
}

TEST(Residency, MoreVersionsMayTurnAWholeFieldIntoOneByNeedAndMarksMayComeLater) {
  const engine::Version field = partField();
  engine::LiveField live(field, engine::Growth::kAllowed);
  ASSERT_TRUE(live.setHeight(750, 550, 3.0F));
  // One fits, two do not.
  auto picture = makePicture({.budget = 10000000}), whole = makePicture();
  Shown shown;
  shown.versions = {field};
  ASSERT_TRUE(picture->update(shown));
  FrameInput input = bare(8);
  EXPECT_FALSE(settle(*picture, input).stats.residency.by_need);
  shown.versions = {live.snapshot(), field};
  ASSERT_TRUE(picture->update(shown));
  ASSERT_TRUE(whole->update(shown));
  const Frame two = settle(*picture, input);
  EXPECT_TRUE(two.stats.residency.by_need);
  EXPECT_EQ(differing(two.image, settle(*whole, input).image), 0U);
  shown.versions = {field};
  shown.marks = MarksOverlay::kShow;
  ASSERT_TRUE(picture->update(shown));
  ASSERT_TRUE(whole->update(shown));
  const Frame one = settle(*picture, input);
  EXPECT_TRUE(one.stats.residency.by_need);
  EXPECT_LE(one.stats.residency.device_bytes, 10000000);
  EXPECT_EQ(differing(one.image, settle(*whole, input).image), 0U);
  // A field of its own is looked at afresh.
  ASSERT_TRUE(picture->update(fieldOf(gridOf(300, 300, 0.05, 0.05), part)));
  EXPECT_FALSE(settle(*picture, input).stats.residency.by_need);
}

// What looking pages up costs, for the record; time is not judged here.
TEST(Residency, ALargePictureFromPagesIsTheSameAndItsTimeIsTold) {
  auto tight = makePicture({.budget = 5800000}), whole = makePicture();
  ASSERT_TRUE(tight->update(partField()));
  ASSERT_TRUE(whole->update(partField()));
  FrameInput input = bare(4);
  input.view.width = 1280;
  input.view.height = 800;
  const Frame a = settle(*tight, input), b = settle(*whole, input);
  EXPECT_EQ(a.stats.residency.pages_beyond, 0);
  EXPECT_EQ(differing(a.image, b.image), 0U);
  const auto median = [](std::vector<double> ms) {
    std::nth_element(ms.begin(), ms.begin() + static_cast<std::ptrdiff_t>(ms.size() / 2), ms.end());
    return ms[ms.size() / 2];
  };
  std::vector<double> device[2], host[2];
  for (int i = 0; i < 9; ++i) {
    // A picture of which nothing changes would not be drawn again.
    input.view.azimuth_deg += 0.01;
    for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
      const auto stats = (k == 0 ? whole : tight)->drawAndWait(input);
      ASSERT_TRUE(stats);
      device[k].push_back(stats->device_ms);
      host[k].push_back(stats->select_ms + stats->record_ms);
    }
  }
  std::printf(
      "1280 x 800, medians of 9: whole %.1f ms drawing, %.2f ms on the host; by need %.1f ms, %.2f ms\n",
      median(device[0]), median(host[0]), median(device[1]), median(host[1]));
}

TEST(Residency, ABudgetThatHoldsNotEvenTheCoarseCopiesIsRefused) {
  auto tight = makePicture({.budget = 40000});
  const auto refused = tight->update(partField());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, engine::ErrorKind::kFailed);
  // The picture goes on with what does fit.
  ASSERT_TRUE(tight->update(fieldOf(gridOf(64, 64, 1, 1), part)));
  EXPECT_FALSE(shoot(*tight, bare(1)).stats.residency.by_need);
}

}  // namespace
}  // namespace fettle::render
