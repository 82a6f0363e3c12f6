// The stylus as a pen: where it stands, its shadow, what hides it, and that without it nothing is different.
#include "render/plan/stylus_body.h"

#include <cmath>
#include <cstdlib>

#include <glm/geometric.hpp>

#include "render/live/live_plan.h"
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

// 64 x 48 mm, flat, with a wall 8 mm high behind y = 30.
engine::Version stepField() {
  return fieldOf(gridOf(640, 480, 0.1, 0.1), [](int, int r) { return r > 300 ? 8.0 : 0.0; });
}
constexpr glm::dvec3 kOnFloor{32.0, 16.0, 0.0};

FrameInput obliqueInput() {
  FrameInput input = bare();
  input.view.azimuth_deg = 0;
  input.view.elevation_deg = 40;
  input.view.vertical_exaggeration = 1.0;
  return input;
}

// A pixel of an image as its lightness, 0 .. 765.
int lightness(const Image& image, int x, int y) {
  const std::uint8_t* p = pixel(image, x, y);
  return p[0] + p[1] + p[2];
}

struct Change {
  int pixels = 0, darker = 0;
  glm::dvec2 middle{0.0}, low{1e9}, high{-1e9};  // of the differing ones
};
Change changeOf(const Image& a, const Image& b, int least = 6) {
  Change d;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const int by = lightness(b, x, y) - lightness(a, x, y);
      const std::uint8_t *p = pixel(a, x, y), *q = pixel(b, x, y);
      int most = 0;
      for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(p[k] - q[k]));
      if (most < least) continue;
      ++d.pixels;
      d.darker += by < 0;
      const glm::dvec2 at(x + 0.5, y + 0.5);
      d.middle += at;
      d.low = glm::min(d.low, at);
      d.high = glm::max(d.high, at);
    }
  if (d.pixels > 0) d.middle /= d.pixels;
  return d;
}

glm::dvec2 pixelOf(const LivePicture& picture, const glm::dvec3& field_mm) {
  const auto at = picture.pixelOf(0, field_mm);
  EXPECT_TRUE(at);
  return at ? glm::dvec2(at->first, at->second) : glm::dvec2(0.0);
}

TEST(StylusBody, AHandBeforeThePictureHoldsItUpwardsFromEverySide) {
  for (const double elevation : {0.0, 10.0, 45.0, 90.0})
    for (const double azimuth : {0.0, 100.0, 315.0}) {
      View view;
      view.azimuth_deg = azimuth;
      view.elevation_deg = elevation;
      const Box box{{-40, -30, -5}, {40, 30, 5}};
      const Camera camera = Camera::fit(view, box, box, {0, 0, 640, 400});
      const glm::dvec3 tail = usualTail(camera);
      EXPECT_NEAR(glm::length(tail), 1.0, 1e-12);
      EXPECT_GT(tail.z, 0.7);
      // To the right in the picture, and to the viewer's side of the tip.
      const glm::dvec2 drawn = camera.pixelOf(20.0 * tail) - camera.pixelOf(glm::dvec3(0.0));
      EXPECT_GT(drawn.x, 20.0);
      EXPECT_GT(glm::dot(tail, camera.toViewer()), 0.2);
      // From above it does not lie on the line of sight.
      if (elevation == 90.0) {
        EXPECT_GT(drawn.y, 10.0);
      } else {
        EXPECT_LT(drawn.y, -20.0);
      }
    }
}

TEST(StylusPicture, ItsPointIsAtTheTipAndItsLengthIsInPixels) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(stepField()));
  FrameInput input = obliqueInput();
  const Shot plain = drawComplete(*picture, input);
  input.overlays.stylus = StylusBody{.tip_mm = kOnFloor, .to_tail = glm::dvec3(1, 0, 0), .shadow = false};
  const Shot drawn = shoot(*picture, input);
  // It lies along x, so that it is as long in the picture as it says and as thick as a pen.
  const Change body = changeOf(plain.image, drawn.image);
  const glm::dvec2 tip = pixelOf(*picture, kOnFloor);
  EXPECT_NEAR(body.low.x, tip.x, 3.0);
  EXPECT_NEAR(body.high.x - body.low.x, 96.0, 4.0);
  EXPECT_NEAR(body.middle.y, tip.y, 2.5);
  EXPECT_NEAR(body.high.y - body.low.y, 2 * 0.065 * 96.0, 3.0);
  // Only the picture over the surface is other: nothing of the surface was drawn again.
  EXPECT_EQ(drawn.stats.redrawn, 0.0);
  // And without it again the picture is bit-identical.
  input.overlays.stylus.reset();
  EXPECT_EQ(shoot(*picture, input).image.rgba, plain.image.rgba);
}

TEST(StylusPicture, TheShadowMeetsTheTipThatTouchesAndMovesAwayAsItRises) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(stepField()));
  FrameInput input = obliqueInput();
  double before_px = 0.0;
  int before_dark = 0;
  for (const double height_mm : {0.0, 4.0, 9.0}) {
    const glm::dvec3 tip = kOnFloor + glm::dvec3(0.0, 0.0, height_mm);
    input.overlays.stylus = StylusBody{.tip_mm = tip, .shadow = false};
    const Shot without = drawComplete(*picture, input);
    input.overlays.stylus->shadow = true;
    const Shot with = shoot(*picture, input);
    const Change shadow = changeOf(without.image, with.image);
    ASSERT_GT(shadow.pixels, 100) << height_mm;
    EXPECT_EQ(shadow.darker, shadow.pixels) << height_mm;
    // The light comes from the upper left: the nearest dark pixel is below and to the right of the tip.
    const glm::dvec2 at = pixelOf(*picture, tip);
    double nearest_px = 1e9;
    int darkest = 0;
    for (int y = 0; y < with.image.height; ++y)
      for (int x = 0; x < with.image.width; ++x) {
        const int by = lightness(without.image, x, y) - lightness(with.image, x, y);
        darkest = std::max(darkest, by);
        if (by > 12) nearest_px = std::min(nearest_px, glm::length(glm::dvec2(x + 0.5, y + 0.5) - at));
      }
    if (height_mm == 0.0) {
      EXPECT_LT(nearest_px, 3.0);
    } else {
      EXPECT_GT(nearest_px, before_px + 8.0);
      EXPECT_LT(darkest, before_dark);
      EXPECT_GT(shadow.middle.x, at.x);
      EXPECT_GT(shadow.middle.y, at.y);
    }
    before_px = nearest_px;
    before_dark = darkest;
  }
}

TEST(StylusPicture, WhatTheSurfaceHidesOfItIsSeenFaintly) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(stepField()));
  FrameInput input = obliqueInput();
  input.view.azimuth_deg = 180;  // from behind the wall
  input.view.elevation_deg = 20;
  const Shot plain = drawComplete(*picture, input);
  const auto change = [&](const glm::dvec3& tip) {
    input.overlays.stylus =
        StylusBody{.tip_mm = tip, .to_tail = glm::dvec3(1, 0, 0), .length_px = 60, .shadow = false};
    const Shot drawn = shoot(*picture, input);
    const glm::dvec2 in = pixelOf(*picture, tip);
    const int x = static_cast<int>(in.x) - 30, y = static_cast<int>(in.y);  // x runs to the left
    return std::abs(lightness(drawn.image, x, y) - lightness(plain.image, x, y));
  };
  const int hidden = change({32, 28, 2}), seen = change({32, 28, 12});
  EXPECT_GT(hidden, 8);
  EXPECT_GT(seen, 2 * hidden);
}

TEST(StylusPicture, ABallIsAsLargeAsItFeelsAndIsStretchedAsHeightsAre) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(stepField()));
  FrameInput input = obliqueInput();
  input.view.elevation_deg = 0.5;
  for (const double exaggeration : {1.0, 2.0}) {
    input.view.vertical_exaggeration = exaggeration;
    const Shot plain = drawComplete(*picture, input);
    const glm::dvec3 centre = kOnFloor + glm::dvec3(0, 0, 6);
    // The pen is all but behind it.
    input.overlays.stylus = StylusBody{.tip_mm = centre,
                                       .ball_radius_mm = 3.0,
                                       .to_tail = glm::dvec3(0, 1, 0),
                                       .length_px = 1.0,
                                       .shadow = false};
    const Change ball = changeOf(plain.image, shoot(*picture, input).image);
    input.overlays.stylus.reset();
    const glm::dvec2 side = pixelOf(*picture, centre + glm::dvec3(3, 0, 0)) - pixelOf(*picture, centre);
    EXPECT_NEAR(ball.high.x - ball.low.x, 2.0 * side.x, 2.5);
    EXPECT_NEAR(ball.high.y - ball.low.y, exaggeration * 2.0 * side.x, 3.0);
  }
}

TEST(StylusPicture, EverySharpnessProjectionAndBothEyesShowIt) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(partField()));
  for (FrameInput input : views())
    for (const Sharpness sharpness : {Sharpness::kFull, Sharpness::kHalf, Sharpness::kFine})
      for (const StereoMode eyes : {StereoMode::kOff, StereoMode::kSideBySide}) {
        input.sharpness = sharpness;
        input.stereo.mode = eyes;
        input.overlays.stylus.reset();
        const Shot plain = drawComplete(*picture, input);
        input.overlays.stylus = StylusBody{.tip_mm = {32, 24, 6}, .ball_radius_mm = 0.5};
        EXPECT_GT(changeOf(plain.image, shoot(*picture, input).image).pixels, 150);
      }
}

TEST(StylusPicture, ACoordinateThatIsNoNumberShowsNone) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(stepField()));
  FrameInput input = obliqueInput();
  const Shot plain = drawComplete(*picture, input);
  for (const glm::dvec3& tail : {glm::dvec3(0.0), glm::dvec3(0, 0, double{kNan})}) {
    input.overlays.stylus = StylusBody{.tip_mm = kOnFloor, .to_tail = tail};
    EXPECT_EQ(shoot(*picture, input).image.rgba, plain.image.rgba);
  }
  input.overlays.stylus = StylusBody{.tip_mm = {double{kNan}, 0, 0}};
  EXPECT_EQ(shoot(*picture, input).image.rgba, plain.image.rgba);
}

}  // namespace
}  // namespace fettle::render
