// Contour lines (shaders/contours.glsl): of one width wherever they are, none where noise crosses a level.
#include <algorithm>
#include <cmath>

#include "tests/render/support/fields.h"

namespace fettle::render {
namespace {

// Normal noise of standard deviation 1 by the sum of twelve uniform numbers, the same for a sample in every run.
double noiseAt(int column, int row) {
  std::uint32_t state = 2654435761U * static_cast<std::uint32_t>(column + 1) ^
                        2246822519U * static_cast<std::uint32_t>(row + 1);
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) {
    state ^= state << 13U;
    state ^= state >> 17U;
    state ^= state << 5U;
    sum += state / 4294967296.0;
  }
  return sum;
}

constexpr int kSide = 300;

Still drawn(const std::function<double(int, int)>& height, double step) {
  Still still = mapOf(fieldOf(gridOf(kSide, kSide), height), 320, 320);
  still.input.range = ValueRange{-50, 50};
  still.input.contours = Contours::kShow;
  still.input.colouring = {.map = ColourMap::kGrey, .contour_step = step};
  still.input.form = {};
  still.input.sharpness = Sharpness::kFull;
  return still;
}

// How much ink lies on a line of pixels across the picture, in whole pixels, of those that are clearly darker without
// noise in their light: the difference from the picture without lines.
double ink(LivePicture& picture, Still still, int row) {
  const Image with = shoot(picture, still).image;
  still.input.contours = Contours::kHide;
  const Image without = shoot(picture, still).image;
  double sum = 0.0;
  for (int x = 40; x < 280; ++x) {
    const double before = pixel(without, x, row)[1], after = pixel(with, x, row)[1];
    // 0.7 of the light at a line's middle: that leaves this share of the code.
    const double least = std::pow(0.3, 1 / 2.4);
    sum += std::min(1.0, (before - after) / (before * (1.0 - least)));
  }
  return sum;
}

TEST(ContourLines, AreOfOneWidthHoweverSteepTheSurface) {
  LivePicture* picture = sharedPicture();
  ASSERT_NE(picture, nullptr);
  // Lines 40 samples apart on a slope, and the same number where it is ten times as steep.
  const double gentle = ink(*picture, drawn([](int c, int) { return 0.1 * c; }, 4.0), 160);
  const double steep = ink(*picture, drawn([](int c, int) { return 1.0 * c; }, 40.0), 160);
  // 240 px of 1.05 px a sample: 5 or 6 lines, each of 2 px between half ink and half ink.
  EXPECT_NEAR(gentle, 5.7 * 2.0, 3.0);
  EXPECT_NEAR(steep, gentle, 2.0);
}

TEST(ContourLines, NoiseOnALevelPlainIsNotInked) {
  LivePicture* picture = sharedPicture();
  ASSERT_NE(picture, nullptr);
  // A plain at a level: without that rule half of it is dark. And one without noise.
  double noisy = 0.0, level = 0.0;
  const Still noise = drawn([](int c, int r) { return 4.0 + 0.05 * noiseAt(c, r); }, 4.0);
  const Still plain = drawn([](int, int) { return 4.0; }, 4.0);
  for (int row = 40; row < 280; row += 24) {
    noisy += ink(*picture, noise, row) / (10 * 240);
    level += ink(*picture, plain, row) / (10 * 240);
  }
  // One place in two hundred rises by more than the noise (contours.glsl); a tenth of the ink is partial.
  EXPECT_LT(noisy, 0.02);
  EXPECT_LT(level, 0.005);
  // A slope through the same noise has its lines.
  const double slope =
      ink(*picture, drawn([](int c, int r) { return 0.1 * c + 0.05 * noiseAt(c, r); }, 4.0), 160);
  EXPECT_NEAR(slope, 5.7 * 2.0, 5.0);
}

TEST(ContourLines, AStepHasThemAndSoDoDeviations) {
  LivePicture* picture = sharedPicture();
  ASSERT_NE(picture, nullptr);
  // Over ten samples by 20, through one level; the plains beside it are on none.
  const Still step = drawn([](int c, int) { return 2.0 + 2.0 * std::clamp(c - 145, 0, 10); }, 16.0);
  EXPECT_NEAR(ink(*picture, step, 160), 2.0, 1.2);
  Still change = drawn([](int c, int r) { return 5.0 * std::sin(0.1 * r) + 0.1 * c; }, 4.0);
  change.shown.original = fieldOf(gridOf(kSide, kSide), [](int, int r) { return 5.0 * std::sin(0.1 * r); });
  EXPECT_NEAR(ink(*picture, change, 160), 5.7 * 2.0, 3.5);
}

}  // namespace
}  // namespace fettle::render
