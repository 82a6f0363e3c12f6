// Frames of half the sharpness and of a quarter, while the camera moves.
#include <random>

#include "engine/field/live_field.h"
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

// Mean over pixels of the largest channel difference, `a` being looked at (dx, dy) pixels aside.
double meanOff(const Image& a, const Image& b, int dx = 0, int dy = 0) {
  double sum = 0.0;
  int n = 0;
  for (int y = 2; y < a.height - 2; ++y)
    for (int x = 2; x < a.width - 2; ++x, ++n) {
      int off = 0;
      for (int k = 0; k < 3; ++k)
        off = std::max(off, std::abs(pixel(a, x + dx, y + dy)[k] - pixel(b, x, y)[k]));
      sum += off;
    }
  return sum / n;
}

// Pixels of `half` with a channel outside what `full` has within three pixels of it, and four codes.
int outside(const Image& half, const Image& full) {
  int n = 0;
  for (int y = 3; y < full.height - 3; ++y)
    for (int x = 3; x < full.width - 3; ++x) {
      bool off = false;
      for (int k = 0; k < 3; ++k) {
        int low = 255, high = 0;
        for (int v = y - 3; v <= y + 3; ++v)
          for (int u = x - 3; u <= x + 3; ++u) {
            low = std::min<int>(low, pixel(full, u, v)[k]);
            high = std::max<int>(high, pixel(full, u, v)[k]);
          }
        const int value = pixel(half, x, y)[k];
        off = off || value < low - 4 || value > high + 4;
      }
      n += off;
    }
  return n;
}

TEST(Live, HalfAsSharpIsTheSamePictureWithoutItsFinestDetail) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(partField()));
  int width = 480;
  for (FrameInput input : views()) {
    SCOPED_TRACE(testing::Message() << input.view.azimuth_deg << ' ' << input.view.elevation_deg << ' '
                                    << static_cast<int>(input.view.projection));
    // Odd sizes as well.
    input.view.width = width++;
    input.view.height = 321;
    const Shot sharp = shoot(*picture, input);
    input.sharpness = Sharpness::kHalf;
    const Shot half = shoot(*picture, input);
    EXPECT_EQ(half.stats.bound_px, sharp.stats.bound_px);
    const double off = meanOff(half.image, sharp.image);
    EXPECT_GT(off, 0.0);
    // Measured 1.3 to 2.7: noise of a code or a few, and what is 50 codes away along edges.
    EXPECT_LT(off, 4.0);
    // It lies where the sharp one does: looked at from a pixel aside it fits worse.
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
      EXPECT_GT(meanOff(half.image, sharp.image, dx, dy), off) << dx << ' ' << dy;
    // Interpolated between what the surface shows within two pixels. At its edges a triangle may cover a
    // pixel's middle in one picture alone, and of noise either may show the extreme: of one in a hundred.
    EXPECT_LE(outside(half.image, sharp.image), width * 321 / 100);
  }
}

TEST(Live, HalfAsSharpLeavesDecorationsSharpAndNoTraceInTheFramesAfterIt) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(partField()));
  FrameInput input = bare(640, 400);
  input.decoration = Decoration::kFull;
  OverlayLine on_top{{5, 5, 8}, {40, 40, 8}};
  OverlayLine in_scene{{5, 40, 1}, {60, 10, 1}};
  in_scene.depth = OverlayLine::Depth::kInScene;
  input.overlays.lines = {on_top, in_scene};
  for (const StereoMode mode : {StereoMode::kOff, StereoMode::kSideBySide, StereoMode::kAnaglyph}) {
    SCOPED_TRACE(static_cast<int>(mode));
    input.stereo.mode = mode;
    input.sharpness = Sharpness::kFull;
    auto fresh = makePicture();
    ASSERT_TRUE(fresh->update(partField()));
    const Shot sharp = shoot(*fresh, input);
    input.sharpness = Sharpness::kHalf;
    const Shot half = shoot(*picture, input);
    EXPECT_NE(half.image.rgba, sharp.image.rgba);
    EXPECT_EQ(half.stats.redrawn, 1.0);
    if (mode != StereoMode::kSideBySide) {
      // Colour bar and its numbers are right of the plot, the scale bar below it: no pixel of theirs differs.
      for (int y = 0; y < 400; ++y)
        for (int x = 560; x < 640; ++x)
          ASSERT_TRUE(
              std::equal(pixel(half.image, x, y), pixel(half.image, x, y) + 4, pixel(sharp.image, x, y)))
              << x << ' ' << y;
    }
    input.sharpness = Sharpness::kFull;
    EXPECT_EQ(shoot(*picture, input).image.rgba, sharp.image.rgba);
    // Nor in those that draw a kPart alone.
    EXPECT_EQ(shoot(*picture, input).image.rgba, sharp.image.rgba);
  }
}

// Channel differences of a picture within its own pixels, in the mean: how much detail it has.
double meanStep(const Image& a) {
  double sum = 0.0;
  int n = 0;
  for (int y = 2; y < a.height - 2; ++y)
    for (int x = 2; x < a.width - 2; ++x, ++n)
      for (int k = 0; k < 3; ++k) sum += std::abs(pixel(a, x + 1, y)[k] - pixel(a, x, y)[k]);
  return sum / n;
}

TEST(Live, AQuarterAsSharpIsTheSamePictureWithLessDetailAndLeavesNoTrace) {
  auto picture = makePicture();
  ASSERT_TRUE(picture);
  ASSERT_TRUE(picture->update(partField()));
  // Sizes of every remainder by four.
  int width = 480, height = 321;
  for (FrameInput input : views()) {
    input.view.width = width++;
    input.view.height = height++;
    SCOPED_TRACE(testing::Message() << input.view.width << " x " << input.view.height);
    input.sharpness = Sharpness::kFull;
    const Shot sharp = shoot(*picture, input);
    input.sharpness = Sharpness::kHalf;
    const Shot half = shoot(*picture, input);
    input.sharpness = Sharpness::kQuarter;
    const Shot quarter = shoot(*picture, input);
    EXPECT_EQ(quarter.stats.bound_px, sharp.stats.bound_px);
    EXPECT_EQ(quarter.stats.redrawn, 1.0);
    const double off = meanOff(quarter.image, sharp.image);
    EXPECT_GT(off, meanOff(half.image, sharp.image));
    EXPECT_LT(off, 8.0);
    EXPECT_LT(meanStep(quarter.image), meanStep(half.image));
    // It lies where the sharp one does.
    for (const auto& [dx, dy] : {std::pair{2, 0}, {-2, 0}, {0, 2}, {0, -2}})
      EXPECT_GT(meanOff(quarter.image, sharp.image, dx, dy), off) << dx << ' ' << dy;
    input.sharpness = Sharpness::kFull;
    EXPECT_EQ(shoot(*picture, input).image.rgba, sharp.image.rgba);
  }
}

// Layers of a size that was left are not taken up again with pictures that are gone.
TEST(Live, ASizeThatComesBackIsDrawnAsItWas) {
  for (const Sharpness sharpness : {Sharpness::kHalf, Sharpness::kQuarter, Sharpness::kFine}) {
    SCOPED_TRACE(static_cast<int>(sharpness));
    auto picture = makePicture();
    ASSERT_TRUE(picture);
    ASSERT_TRUE(picture->update(partField()));
    FrameInput input = views().front();
    const auto drawn = [&](int width, Sharpness as) {
      input.view.width = width;
      input.view.height = 321;
      input.sharpness = as;
      return shoot(*picture, input).image;
    };
    const Image before = drawn(480, sharpness);
    (void)drawn(500, Sharpness::kFull);
    (void)drawn(480, Sharpness::kFull);
    EXPECT_EQ(drawn(480, sharpness).rgba, before.rgba);
    for (const std::string& message : picture->validationMessages()) ADD_FAILURE() << message;
  }
}

}  // namespace
}  // namespace fettle::render
