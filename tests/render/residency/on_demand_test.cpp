// Fields of which the device holds a part: which one, and that the picture says and shows what it should.
#include "render/residency/residency.h"

#include <cstdio>
#include <random>

#include "engine/field/live_field.h"
#include "engine/marks/change_marks.h"
#include "render/residency/page_table.h"
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

TEST(Residency, AFieldThatFitsIsThereAsAWhole) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(largeField()));
  EXPECT_FALSE(shoot(*picture, bareAt(1)).stats.residency.on_demand);
}

TEST(Residency, TheFirstPictureOfALargeFieldWaitsForACoarseCopyAlone) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(wideField(0.0)));
  const Shot first = shoot(*picture, bareAt(1));
  EXPECT_TRUE(first.stats.residency.on_demand);
  // 20.8 MB of samples; every 4th each way before the first picture, and then what it asks for.
  EXPECT_LT(first.stats.upload.bytes, (std::int64_t{8} << 20) + (std::int64_t{6} << 20));
  EXPECT_LT(first.stats.residency.device_bytes, std::int64_t{64} << 20);
}

TEST(Residency, AVersionThatJoinsBringsALittleAtOnce) {
  auto picture = makePicture({.bytes_per_frame = 65536});
  Shown shown;
  shown.versions = {wideField(0.0)};
  ASSERT_TRUE(picture->update(shown));
  EXPECT_GT(drawComplete(*picture, bareAt(1)).stats.residency.pages_used, 0);
  shown.versions.push_back(wideField(0.3));
  ASSERT_TRUE(picture->update(shown));
  // 1 MiB of coarse samples, a page, and the other one's edge.
  EXPECT_LT(shoot(*picture, bareAt(1)).stats.upload.bytes, std::int64_t{3} << 19);
  picture->refreshRanges();
  const Shot joined = drawComplete(*picture, bareAt(1));
  auto fresh = makePicture();
  ASSERT_TRUE(fresh->update(shown));
  EXPECT_EQ(differing(joined.image, drawComplete(*fresh, bareAt(1)).image), 0U);
}

TEST(Residency, FramesWithoutTimeUploadAPageEach) {
  LiveOptions options;
  options.uploading_ms = 0.0;
  auto hurried = LivePicture::create(options);
  ASSERT_TRUE(hurried) << hurried.error().line();
  ASSERT_TRUE((*hurried)->update(wideField(0.0)));
  auto usual = makePicture();
  ASSERT_TRUE(usual->update(wideField(0.0)));
  int frames = 0, of_usual = 0;
  const Shot a = drawComplete(**hurried, bareAt(4), &frames), b = drawComplete(*usual, bareAt(4), &of_usual);
  EXPECT_EQ(differing(a.image, b.image), 0U);
  EXPECT_GT(frames, of_usual);
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
    const FrameInput input = bareAt(zoom, 0.4, 0.3);
    ASSERT_TRUE(stays->update(before));
    const Shot old = drawComplete(*stays, input);
    ASSERT_TRUE(stays->update(after));
    ASSERT_TRUE(fresh->update(after));
    stays->refreshRanges();
    const Shot a = drawComplete(*stays, input), b = drawComplete(*fresh, input);
    EXPECT_TRUE(a.stats.residency.on_demand);
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
    auto tight = makePicture({.budget = budget, .bytes_per_frame = 300000}), whole = makePicture();
    Shown shown;
    const engine::Version first = holed ? holedField() : largeField();
    shown.versions = {first};
    shown.marks = holed ? MarksOverlay::kHide : MarksOverlay::kShow;
    engine::LiveField live(first, engine::Growth::kAllowed);
    ASSERT_TRUE(tight->update(shown));
    ASSERT_TRUE(whole->update(shown));
    std::int64_t loaded = 0, gone_coarse = 0;
    for (int round = 0; round < 9; ++round) {
      SCOPED_TRACE(round);
      FrameInput input = bareAt(uniform(4, 30), uniform(0, 1), uniform(0, 1));
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
      Shot frame;
      do {
        frame = shoot(*tight, input);
        const ResidencyStatistics& r = frame.stats.residency;
        ASSERT_TRUE(r.on_demand);
        ASSERT_LE(r.device_bytes, budget);
        ASSERT_LE(r.pages_used, r.pages);
        // Never more than is allowed, or one tile (and its pages) or page where that is larger.
        ASSERT_LE(frame.stats.upload.bytes, 300000 + 6 * 20480);
        loaded += r.pages_loaded;
        gone_coarse += frame.stats.bound_px > 1.0;
      } while (frame.stats.residency.pages_loaded > 0 || frame.stats.upload.pending_tiles > 0);
      ASSERT_EQ(frame.stats.residency.pages_over_budget, 0) << frame.stats.residency.pages_requested;
      const Shot expected = drawComplete(*whole, input);
      EXPECT_FALSE(expected.stats.residency.on_demand);
      EXPECT_EQ(frame.stats.bound_px, expected.stats.bound_px);
      EXPECT_EQ(frame.stats.vertices, expected.stats.vertices);
      EXPECT_EQ(differing(frame.image, expected.image), 0U);
    }
    EXPECT_GT(loaded, 80);
    EXPECT_GT(gone_coarse, 3);
  }
}

TEST(Residency, TheBoundHoldsWhilePagesAreMissingAndShrinksAsTheyCome) {
  // Without noise: it would show in the light on coarse samples, which is not what the bound speaks of.
  const engine::Version field = fieldOf(gridOf(kWidth, kHeight, 0.05, 0.05), [](int c, int r) {
    const double x = c * 0.05, y = r * 0.05;
    return 0.03 * x + 2.0 * std::sin(0.35 * x) * std::cos(0.3 * y) + (y > 8 && y < 12 ? -3.0 : 0.0);
  });
  // Two pages a frame.
  auto tight = makePicture({.budget = 2900000, .bytes_per_frame = 2 * 16384}), whole = makePicture();
  ASSERT_TRUE(tight->update(field));
  ASSERT_TRUE(whole->update(field));
  int with_missing = 0;
  for (const auto& [zoom, x, y, elevation] :
       {std::tuple{6.0, 0.3, 0.2, 40.0}, {8.0, 0.8, 0.7, 25.0}, {5.0, 0.5, 0.5, 90.0}}) {
    FrameInput input = bareAt(zoom, x, y);
    input.view.elevation_deg = elevation;
    input.view.width = 240;
    input.view.height = 160;
    FrameInput full = input;
    full.error_px = 1e-9;
    full.vertex_budget = 1 << 24;
    const Shot fine = drawComplete(*whole, full);
    ASSERT_LE(fine.stats.bound_px, 1e-9);
    double least = 1e9;
    for (int frame = 0; frame < 60; ++frame) {
      const Shot coarse = shoot(*tight, input);
      if (coarse.stats.residency.pages_waiting == 0) break;
      EXPECT_GE(coarse.stats.residency.pages_loaded, 1);
      // The first frame reports the coarse copies as well, uploaded by update().
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
    const Shot done = drawComplete(*tight, input);
    EXPECT_EQ(done.stats.bound_px, drawComplete(*whole, input).stats.bound_px);
    EXPECT_LE(done.stats.bound_px, least);
  }
  EXPECT_GT(with_missing, 5);
}

TEST(Residency, AViewOfMoreThanTheBudgetComesToRestAndSaysWhatItShows) {
  auto tight = makePicture({.budget = 450000});
  ASSERT_TRUE(tight->update(largeField()));
  FrameInput input = bareAt(1);
  input.view.elevation_deg = 60;
  Shot rest = drawComplete(*tight, input);
  EXPECT_GT(rest.stats.residency.pages_over_budget, 0);
  EXPECT_LE(rest.stats.residency.device_bytes, 450000);
  EXPECT_GT(rest.stats.bound_px, 1.0);
  // At rest: nothing is uploaded any more, and the picture does not change.
  for (int i = 0; i < 3; ++i) {
    const Shot again = shoot(*tight, input);
    EXPECT_EQ(again.stats.residency.pages_loaded, 0);
    EXPECT_EQ(again.stats.upload.bytes, 0);
    EXPECT_EQ(again.image.rgba, rest.image.rgba);
  }
}

TEST(Residency, AFieldLargerThanTheDevicesImagesIsDrawnFromPages) {
  // 63 samples more than one image of the forced limit would hold each way, many times over.
  const engine::Version field = fieldOf(gridOf(6000, 190, 0.05, 0.05), kLargePart);
  auto tight = makePicture({.budget = 2900000, .max_side = 64}), whole = makePicture();
  ASSERT_TRUE(tight->update(field));
  ASSERT_TRUE(whole->update(field));
  for (const double x : {0.0, 0.31, 0.77, 1.0}) {
    FrameInput input = bareAt(12, x, 0.5);
    const Shot a = drawComplete(*tight, input), b = drawComplete(*whole, input);
    EXPECT_TRUE(a.stats.residency.on_demand);
    EXPECT_EQ(a.stats.residency.pages_over_budget, 0);
    EXPECT_EQ(differing(a.image, b.image), 0U) << x;
  }
}

TEST(Residency, AnEditBesideTheViewCostsItsCoarseCopiesAlone) {
  auto tight = makePicture({.budget = 1500000});
  const engine::Version before = largeField();
  ASSERT_TRUE(tight->update(before));
  const FrameInput input = bareAt(12, 0.2, 0.2);
  (void)drawComplete(*tight, input);
  engine::LiveField live(before, engine::Growth::kAllowed);
  const std::vector<float> z(64 * 64, 7.0F);
  ASSERT_TRUE(live.writeHeights(1280, 960, 64, 64, z.data(), 64));
  ASSERT_TRUE(tight->update(live.snapshot()));
  const Shot far = shoot(*tight, input);
  // Every 16th and 64th sample stay on the device; every 4th comes on demand.
  EXPECT_EQ(far.stats.upload.bytes, (16 + 1) * 4);
  EXPECT_EQ(far.stats.upload.pending_tiles, 0);
  const std::vector<float> near(10 * 10, 7.0F);
  ASSERT_TRUE(live.writeHeights(300, 220, 10, 10, near.data(), 10));
  ASSERT_TRUE(tight->update(live.snapshot()));
  EXPECT_GE(shoot(*tight, input).stats.upload.bytes, 10 * 10 * 4);
}

}  // namespace
}  // namespace fettle::render
