// The picture with four rays per pixel that is drawn band by band while nothing changes.
#include "engine/field/live_field.h"
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

FrameInput atRest(FrameInput input) {
  input.sharpness = Sharpness::kRest;
  return input;
}
FrameInput fine(FrameInput input) {
  input.sharpness = Sharpness::kFine;
  return input;
}

// What a picture that draws nothing else shows.
Shot alone(const engine::Version& field, const FrameInput& input) {
  auto picture = makePicture();
  EXPECT_TRUE(picture->update(field));
  return drawComplete(*picture, input);
}

// Frames until the picture rests; the last one.
Shot untilRest(LivePicture& picture, const FrameInput& input, int* frames = nullptr) {
  for (int n = 1; n < 200; ++n) {
    Shot shot = shoot(picture, atRest(input));
    if (frames != nullptr) *frames = n;
    if (shot.stats.rest_left == 0) return shot;
  }
  ADD_FAILURE() << "never at rest";
  return {};
}

TEST(Rest, ShowsTheWholePictureAndThenTheOneOfFourRays) {
  for (FrameInput input : views()) {
    SCOPED_TRACE(testing::Message() << input.view.azimuth_deg << ' ' << input.view.elevation_deg << ' '
                                    << static_cast<int>(input.view.projection));
    input.view.width = 481;
    input.view.height = 323;
    input.decoration = Decoration::kFull;
    const Shot whole = alone(partField(), input), four = alone(partField(), fine(input));
    ASSERT_GT(differing(whole.image, four.image), 1000U);
    auto picture = makePicture();
    ASSERT_TRUE(picture->update(partField()));
    for (int frame = 0; frame < kRestBands; ++frame) {
      const Shot shot = shoot(*picture, atRest(input));
      EXPECT_EQ(shot.stats.rest_left, kRestBands - frame);
      EXPECT_FALSE(shot.stats.rests);
      EXPECT_EQ(differing(shot.image, whole.image), 0U) << frame;
      EXPECT_EQ(shot.stats.redrawn, frame == 0 ? 1.0 : 0.0);
    }
    for (int frame = 0; frame < 2; ++frame) {
      const Shot shot = shoot(*picture, atRest(input));
      EXPECT_EQ(shot.stats.rest_left, 0);
      EXPECT_TRUE(shot.stats.rests);
      EXPECT_EQ(differing(shot.image, four.image), 0U);
      EXPECT_EQ(shot.stats.bound_px, whole.stats.bound_px);
    }
  }
}

TEST(Rest, AnEditStillDrawsOnlyThePartThatItChanges) {
  engine::LiveField live(partField(), engine::Growth::kAllowed);
  FrameInput input = bare();
  input.range = ValueRange{-3, 9};
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(live.snapshot()));
  (void)untilRest(*picture, input);
  // Within the range of heights, by which a picture is framed when a field is first shown.
  const std::vector<float> bump(10, 2.5F);
  for (int r = 300; r < 310; ++r) {
    ASSERT_TRUE(live.writeHeights(400, r, 10, 1, bump.data(), 10));
  }
  ASSERT_TRUE(picture->update(live.snapshot()));
  const Shot edited = shoot(*picture, atRest(input));
  EXPECT_TRUE(edited.stats.continued);
  EXPECT_LT(edited.stats.redrawn, 0.3);
  EXPECT_FALSE(edited.stats.rests);
  EXPECT_EQ(differing(edited.image, alone(live.snapshot(), input).image), 0U);
  const Shot rests = untilRest(*picture, input);
  EXPECT_EQ(differing(rests.image, alone(live.snapshot(), fine(input)).image), 0U);
}

TEST(Rest, AChangeBetweenTwoBandsBeginsAnew) {
  FrameInput input = bare(), turned = bare();
  turned.view.azimuth_deg += 3.0;
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(partField()));
  for (int frame = 0; frame < kRestBands / 2; ++frame) (void)shoot(*picture, atRest(input));
  turned.sharpness = Sharpness::kHalf;
  (void)shoot(*picture, turned);
  int frames = 0;
  const Shot rests = untilRest(*picture, turned, &frames);
  EXPECT_EQ(frames, 1 + kRestBands);
  turned.sharpness = Sharpness::kFull;
  EXPECT_EQ(differing(rests.image, alone(partField(), fine(turned)).image), 0U);
  // A picture drawn once uses the same layers.
  (void)shoot(*picture, fine(input));
  EXPECT_EQ(differing(untilRest(*picture, turned).image, rests.image), 0U);
  EXPECT_EQ(differing(shoot(*picture, fine(input)).image, alone(partField(), fine(input)).image), 0U);
}

TEST(Rest, LinesMoveOverItWithoutDrawingTheSurfaceAgain) {
  FrameInput input = bare();
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(partField()));
  const Shot rests = untilRest(*picture, input);
  for (int step = 0; step < 3; ++step) {
    const double x = 5.0 + 10.0 * step;
    OverlayLine in_scene{{x, 40, 1}, {60, 10, 1}};
    in_scene.depth = OverlayLine::Depth::kInScene;
    input.overlays.lines = {{{x, 5, 8}, {40, 40, 8}}, in_scene};
    const Shot shot = shoot(*picture, atRest(input));
    EXPECT_TRUE(shot.stats.rests);
    const std::size_t changed = differing(shot.image, rests.image);
    EXPECT_GT(changed, 200U);
    EXPECT_LT(changed, 5000U);  // two lines of some 300 pixels, two wide with soft edges
  }
  input.overlays.lines.clear();
  EXPECT_EQ(differing(shoot(*picture, atRest(input)).image, rests.image), 0U);
}

TEST(Rest, OfAFieldOnDemandWaitsForItsPages) {
  for (const double zoom : {1.0, 14.0}) {
    SCOPED_TRACE(zoom);
    const FrameInput input = bareAt(zoom, 0.4, 0.3);
    auto picture = makePicture();
    ASSERT_TRUE(picture->update(wideField(0.0)));
    const Shot rests = untilRest(*picture, input);
    EXPECT_TRUE(rests.stats.rests);
    FrameInput all = fine(input);
    all.pages = FrameInput::Pages::kAll;
    EXPECT_EQ(differing(rests.image, alone(wideField(0.0), all).image), 0U);
  }
}

// Pages of both pictures do not fit: the whole one stays, and nothing is drawn again for ever.
TEST(Rest, WithoutMemoryForItsPagesIsLeftOut) {
  auto picture = makePicture({.budget = 6 << 20});
  ASSERT_TRUE(picture->update(holedField()));
  const FrameInput input = bareAt(6.0);
  (void)untilRest(*picture, input);
  int redrawn = 0;
  for (int frame = 0; frame < 40; ++frame) {
    const Shot shot = shoot(*picture, atRest(input));
    EXPECT_EQ(shot.stats.rest_left, 0);
    redrawn += shot.stats.redrawn > 0.0 ? 1 : 0;
  }
  EXPECT_LT(redrawn, 20);
}

TEST(Rest, InStereoIsTheWholePicture) {
  FrameInput input = bare(640, 400);
  input.stereo.mode = StereoMode::kSideBySide;
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(partField()));
  const Shot whole = shoot(*picture, input), rest = shoot(*picture, atRest(input));
  EXPECT_EQ(rest.stats.rest_left, 0);
  EXPECT_FALSE(rest.stats.rests);
  EXPECT_EQ(differing(rest.image, whole.image), 0U);
}

}  // namespace
}  // namespace fettle::render
