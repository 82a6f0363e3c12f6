// A picture that becomes finer band by band.
#include <cmath>

#include "engine/field/live_field.h"
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

constexpr std::int64_t kCoarse = 4096, kFine = 1 << 20;

FrameInput with(FrameInput input, std::int64_t vertices,
                FrameInput::Redraw redraw = FrameInput::Redraw::kInBands) {
  input.panel_vertices = {vertices};
  input.redraw = redraw;
  input.range = ValueRange{-3, 9};
  return input;
}

// What a picture that draws nothing else shows.
Shot wholeOf(const engine::Version& field, FrameInput input) {
  input.redraw = FrameInput::Redraw::kAll;
  auto picture = makePicture();
  EXPECT_TRUE(picture->update(field));
  return drawComplete(*picture, input);
}

TEST(DetailBands, EndWithTheBitsOfTheFinePicture) {
  for (FrameInput input : views()) {
    SCOPED_TRACE(testing::Message() << input.view.azimuth_deg << ' ' << input.view.elevation_deg << ' '
                                    << static_cast<int>(input.view.projection));
    input.view.width = 481;
    input.view.height = 323;
    input.decoration = Decoration::kFull;
    const Shot coarse = wholeOf(partField(), with(input, kCoarse)),
               fine = wholeOf(partField(), with(input, kFine));
    auto picture = makePicture();
    ASSERT_TRUE(picture->update(partField()));
    (void)drawComplete(*picture, with(input, kCoarse, FrameInput::Redraw::kChanged));
    if (differing(coarse.image, fine.image) == 0) continue;  // from above heights move no pixel
    for (int left = kDetailBands - 1; left >= 0; --left) {
      const Shot shot = shoot(*picture, with(input, kFine));
      EXPECT_EQ(shot.stats.bands_left, left);
      EXPECT_TRUE(shot.stats.continued);
      EXPECT_LT(shot.stats.redrawn, 1.3 / kDetailBands);
      // The last rows may show nothing but the ground.
      if (left == kDetailBands - 1 || left == 0) {
        EXPECT_EQ(differing(shot.image, fine.image) == 0, left == 0) << left;
      }
    }
    EXPECT_EQ(shoot(*picture, with(input, kFine)).stats.redrawn, 0.0);
    EXPECT_EQ(shoot(*picture, with(input, kFine, FrameInput::Redraw::kChanged)).stats.redrawn, 0.0);
  }
}

// Where each patch of a steep surface reaches from the top of the picture to its bottom, each band would take all of them.
TEST(DetailBands, OfASteepSurfaceTakeFourFrames) {
  const engine::Version needles = fieldOf(
      gridOf(512, 512, 0.1, 0.1), [](int c, int r) { return 6.0 * std::fabs(std::sin(1e3 * c * r)); });
  FrameInput input = bare();
  input.view.vertical_exaggeration = 40.0;
  input.view.zoom = 4.0;
  const Shot fine = wholeOf(needles, with(input, kFine));
  ASSERT_GT(fine.stats.vertices, kFrameVertices);
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(needles));
  (void)drawComplete(*picture, with(input, kCoarse, FrameInput::Redraw::kChanged));
  for (int left = kRoundsOfSteep - 1; left >= 0; --left) {
    const Shot shot = shoot(*picture, with(input, kFine));
    EXPECT_EQ(shot.stats.bands_left, left * kDetailBands / kRoundsOfSteep);
    EXPECT_LT(shot.stats.redrawn, 1.3 / kRoundsOfSteep);
    EXPECT_EQ(differing(shot.image, fine.image) == 0, left == 0) << left;
  }
}

TEST(DetailBands, AnEditInBetweenIsDrawnAtOnceAndTheBandsGoOn) {
  engine::LiveField live(partField(), engine::Growth::kAllowed);
  const FrameInput input = bare();
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(live.snapshot()));
  (void)drawComplete(*picture, with(input, kCoarse, FrameInput::Redraw::kChanged));
  const std::vector<float> bump(20, 2.5F);
  for (int left = kDetailBands - 1; left >= 0; --left) {
    const Shot band = shoot(*picture, with(input, kFine));
    EXPECT_EQ(band.stats.bands_left, left);
    if (left % 2 == 0) continue;
    for (int r = 400; r < 420; ++r)
      ASSERT_TRUE(live.writeHeights(100 + 450 * left / kDetailBands, r, 20, 1, bump.data(), 20));
    ASSERT_TRUE(picture->update(live.snapshot()));
    const Shot edited = shoot(*picture, with(input, kFine));
    EXPECT_EQ(edited.stats.bands_left, left);
    EXPECT_LT(edited.stats.redrawn, 0.3);
    EXPECT_GT(differing(edited.image, band.image), 20U);
  }
  const Shot last = shoot(*picture, with(input, kFine));
  EXPECT_EQ(last.stats.bands_left, 0);
  EXPECT_EQ(differing(last.image, wholeOf(live.snapshot(), with(input, kFine)).image), 0U);
}

TEST(DetailBands, WhatChangesThePictureInBetweenIsDrawnAsAWhole) {
  const FrameInput input = bare();
  FrameInput lit = input, at_rest = input;
  lit.light_azimuth_deg += 90.0;
  at_rest.sharpness = Sharpness::kRest;
  for (const auto& [next, redraw, vertices] : {std::tuple{input, FrameInput::Redraw::kChanged, kCoarse},
                                               {input, FrameInput::Redraw::kChanged, kFine},
                                               {at_rest, FrameInput::Redraw::kChanged, kFine},
                                               {lit, FrameInput::Redraw::kInBands, kCoarse}}) {
    auto picture = makePicture();
    ASSERT_TRUE(picture->update(partField()));
    (void)drawComplete(*picture, with(input, kCoarse, FrameInput::Redraw::kChanged));
    for (int band = 0; band < 3; ++band) (void)shoot(*picture, with(input, kFine));
    const Shot whole = shoot(*picture, with(next, vertices, redraw));
    EXPECT_EQ(whole.stats.redrawn, 1.0);
    EXPECT_EQ(whole.stats.bands_left, 0);
    EXPECT_EQ(differing(whole.image, wholeOf(partField(), with(next, vertices)).image), 0U);
  }
}

TEST(DetailBands, OfAFieldOnDemandBeginAnewWhenPagesCome) {
  const FrameInput input = bareAt(3.0, 0.4, 0.3);
  auto picture = makePicture({.budget = 24 << 20, .bytes_per_frame = 1 << 18});
  ASSERT_TRUE(picture->update(wideField(0.0)));
  (void)drawComplete(*picture, with(input, kCoarse, FrameInput::Redraw::kChanged));
  Shot shot;
  int frames = 0;
  do {
    shot = shoot(*picture, with(input, kFine));
    EXPECT_LE(shot.stats.redrawn, 1.3 / kDetailBands);
  } while ((shot.stats.bands_left > 0 || shot.stats.upload.pending_tiles > 0) && ++frames < 200);
  EXPECT_TRUE(shot.stats.residency.on_demand);
  EXPECT_GE(frames, kDetailBands - 1);
  FrameInput all = with(input, kFine, FrameInput::Redraw::kAll);
  EXPECT_EQ(differing(shot.image, shoot(*picture, all).image), 0U);
}

}  // namespace
}  // namespace fettle::render
