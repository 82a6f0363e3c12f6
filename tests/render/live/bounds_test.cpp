// How near a frame lies to the field, and what it may cost.
#include <random>

#include "engine/field/live_field.h"
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

TEST(Live, TheCoarsePictureLiesWithinItsBoundOfTheFullOne) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(partField()));
  for (const FrameInput& view : views()) {
    SCOPED_TRACE(testing::Message() << view.view.azimuth_deg << ' ' << view.view.elevation_deg << ' '
                                    << static_cast<int>(view.view.projection));
    const Shot fine = shoot(*picture, full(view));
    EXPECT_LE(fine.stats.bound_px, 1e-9);
    for (const double error : {1.0, 3.0}) {
      FrameInput input = view;
      input.error_px = error;
      input.vertex_budget = 1 << 21;
      const Shot coarse = shoot(*picture, input);
      EXPECT_LE(coarse.stats.bound_px, error);
      EXPECT_LE(coarse.stats.vertices, fine.stats.vertices);
      // A displaced point falls on a pixel at most the bound plus a pixel away; what is seen between two rays
      // is not in the picture at all, so that along edges some pixels have no partner: 2 in a thousand, of
      // noise and walls.
      const int radius = static_cast<int>(std::ceil(error)) + 1;
      const int pixels = coarse.image.width * coarse.image.height;
      EXPECT_LE(unmatched(coarse.image, fine.image, radius, 10), pixels / 500) << error;
      EXPECT_LE(unmatched(fine.image, coarse.image, radius, 10), pixels / 500) << error;
    }
  }
}

TEST(Live, NoGroundShowsInsideTheSurfaceAtAnyMixOfStrides) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  // No holes, so no plate lies under the surface: whatever shines through is the ground.
  for (const engine::Version& field : {partField(), fieldOf(gridOf(700, 500, 0.1, 0.1), [](int c, int r) {
                                         return hash01(c / 90, r / 70) < 0.4 ? 0.8 * hash01(c, r) : 0.002 * c;
                                       })}) {
    ASSERT_TRUE(picture->update(field));
    for (FrameInput input : views()) {
      std::vector<char> solid;      // by pixel: the surface lies there, whatever the strides
      input.theme = Theme::kLight;  // no colour of the surface is as light as its ground
      for (const double error : {1.0, 5.0}) {
        input.error_px = error;
        const Shot frame = shoot(*picture, input);
        const int reach = static_cast<int>(std::ceil(frame.stats.bound_px)) + 1;
        // The ground's own colour, from an empty picture.
        FrameInput away = input;
        away.view.zoom = 1e-3;
        const Shot ground = shoot(*picture, away);
        (void)shoot(*picture, input);
        int inside = 0;
        if (solid.empty())
          for (int y = 0; y < input.view.height; ++y)
            for (int x = 0; x < input.view.width; ++x)
              solid.push_back(picture->pick(x + 0.5, y + 0.5).has_value());
        for (int y = reach; y < input.view.height - reach; ++y)
          for (int x = reach; x < input.view.width - reach; ++x) {
            bool deep = true;
            for (int v = -reach; v <= reach && deep; ++v)
              for (int u = -reach; u <= reach && deep; ++u)
                deep = solid[static_cast<std::size_t>((y + v) * input.view.width + x + u)] != 0;
            if (!deep) continue;
            ++inside;
            ASSERT_FALSE(
                std::equal(pixel(frame.image, x, y), pixel(frame.image, x, y) + 3, pixel(ground.image, 0, 0)))
                << x << ' ' << y << " at " << input.view.azimuth_deg << ' ' << input.view.elevation_deg
                << " error " << error;
          }
        EXPECT_GT(inside, 15000);
      }
    }
  }
}

TEST(Live, AFrameWithoutTimeMeasuresSomeTiles) {
  LiveOptions options;
  options.measuring_ms = 0.0;
  auto picture = LivePicture::create(options);
  ASSERT_TRUE(picture) << picture.error().line();
  ASSERT_TRUE((*picture)->update(partField(640, 640)));  // 10 x 10 tiles
  const Shot first = shoot(**picture, bare()), second = shoot(**picture, bare());
  EXPECT_EQ(first.stats.upload.measured_tiles, static_cast<std::int64_t>(kMeasuredAtOnce));
  EXPECT_EQ(second.stats.upload.unmeasured_tiles, 0);
}

TEST(Live, NoFrameMeasuresMoreTilesThanItMayAndEachBoundHolds) {
  // 33 x 16 tiles: twice what a frame may measure.
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  const engine::Version before = partField(2100, 1000);
  constexpr std::int64_t kTiles = 33 * 16, kMost = kMeasuredPerFrame;
  ASSERT_GT(kTiles, 2 * kMost);
  FrameInput input = bare();
  input.range = ValueRange{-3, 9};
  input.view.vertical_exaggeration = 1.0;
  input.vertex_budget = 1 << 22;
  std::optional<Shot> fine;
  const auto framesToRest = [&] {
    // Until a frame is the last one: those before differ from the surface at full resolution by what they
    // say.
    for (int frames = 1; frames < 100; ++frames) {
      const Shot frame = shoot(*picture, input);
      EXPECT_LE(frame.stats.upload.measured_tiles, kMost);
      EXPECT_LE(frame.stats.bound_px, input.error_px);
      EXPECT_TRUE(frame.stats.within_budget);
      if (fine) {
        const int pixels = frame.image.width * frame.image.height;
        EXPECT_LE(unmatched(frame.image, fine->image, 2, 10), pixels / 500) << frames;
        EXPECT_LE(unmatched(fine->image, frame.image, 2, 10), pixels / 500) << frames;
      }
      if (frame.stats.upload.pending_tiles == 0) return std::pair{frames, frame};
      EXPECT_GT(frame.stats.upload.unmeasured_tiles + frame.stats.upload.tiles, 0);
    }
    ADD_FAILURE() << "never at rest";
    return std::pair{0, Shot{}};
  };
  ASSERT_TRUE(picture->update(before));
  const auto [first_frames, first] = framesToRest();
  EXPECT_EQ(first_frames, static_cast<int>((kTiles + kMost - 1) / kMost));

  // A filter changes every sample.
  engine::LiveField live(before, engine::Growth::kAllowed);
  std::vector<float> z(2100 * 1000);
  before.reader().readHeights(0, 0, 2100, 1000, z.data(), 2100);
  for (float& height : z) height *= 1.01F;
  ASSERT_TRUE(live.writeHeights(0, 0, 2100, 1000, z.data(), 2100));
  const engine::Version after = live.snapshot();
  ASSERT_TRUE(picture->update(after));
  const auto [frames, at_rest] = framesToRest();
  EXPECT_GT(frames, 2);

  // And ends with the picture of one that never saw another state; the camera's range is that of the first.
  picture->refreshRanges();
  const Shot last = shoot(*picture, input);
  auto fresh = makePicture();
  ASSERT_TRUE(fresh->update(after));
  const Shot other = drawComplete(*fresh, input);
  EXPECT_EQ(at_rest.stats.patches, last.stats.patches);
  EXPECT_EQ(last.stats.patches, other.stats.patches);
  EXPECT_EQ(last.image.rgba, other.image.rgba);

  // While nothing is known, against the surface at full resolution.
  fine = shoot(*fresh, full(input));
  fresh.reset();
  picture = makePicture();
  ASSERT_TRUE(picture->update(after));
  (void)framesToRest();
}

TEST(Live, VerticesStayWithinTheBudgetWhateverTheFieldAndTheBoundIsSaid) {
  auto picture = makePicture();
  // Noise as high as hills: nothing coarse is close to it.
  ASSERT_TRUE(
      picture->update(fieldOf(gridOf(2048, 2048, 0.1, 0.1), [](int c, int r) { return 30 * hash01(c, r); })));
  for (const std::int64_t budget : {16384, 98304}) {
    FrameInput input = bare();
    input.view.vertical_exaggeration = 1.0;
    input.vertex_budget = budget;
    const Shot frame = shoot(*picture, input);
    EXPECT_LE(frame.stats.vertices, budget);
    EXPECT_GT(frame.stats.vertices, budget / 2);
    EXPECT_FALSE(frame.stats.within_budget);
    EXPECT_GT(frame.stats.bound_px, 1.0);
  }
  // A plane costs next to nothing at any size.
  ASSERT_TRUE(picture->update(
      fieldOf(gridOf(2048, 2048, 0.1, 0.1), [](int c, int r) { return 0.25 * c + 0.5 * r; })));
  const Shot plane = drawComplete(*picture, bare());
  EXPECT_LT(plane.stats.vertices, 4096);
  EXPECT_LE(plane.stats.bound_px, 1.0);
}

TEST(Live, ASpikeOfASingleSampleIsDrawnFromAnyDistance) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(fieldOf(gridOf(2000, 2000, 0.1, 0.1),
                                      [](int c, int r) { return c == 1003 && r == 997 ? 60.0 : 0.01 * c; })));
  FrameInput input = bare();
  input.view.vertical_exaggeration = 1.0;
  input.view.elevation_deg = 20;
  const Shot frame = drawComplete(*picture, input);
  EXPECT_LE(frame.stats.bound_px, 1.0);
  // The finest patch is there: a spike is not stepped over.
  EXPECT_GT(frame.stats.patches, 8);
}

TEST(Live, WhatIsMeasuredBetweenFramesTheNextFrameShows) {
  const engine::Version field = partField(1600, 1200);
  const FrameInput input = bare(480, 320);
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(field));
  const Shot first = shoot(*picture, input);
  const std::int64_t unknown = first.stats.upload.unmeasured_tiles;
  ASSERT_GT(unknown, 0);
  EXPECT_EQ(picture->measureFor(0.0), unknown);
  EXPECT_EQ(picture->measureFor(1e6), 0);
  const Shot known = shoot(*picture, input);
  EXPECT_EQ(known.stats.upload.measured_tiles, 0);
  EXPECT_EQ(known.stats.upload.pending_tiles, 0);
  // As frame by frame.
  auto other = makePicture();
  ASSERT_TRUE(other->update(field));
  const Shot complete = drawComplete(*other, input);
  EXPECT_EQ(known.image.rgba, complete.image.rgba);
  EXPECT_EQ(known.stats.bound_px, complete.stats.bound_px);
}

}  // namespace
}  // namespace fettle::render
