// Pictures drawn in parts against the same drawn as one.
//
// The parts have the same camera, patches, samples and shaders. What differs is single precision: a point's
// place comes out of a matrix about another middle, rounded to some 1e-7 of the picture's side, hence to
// 1e-4 pixels here, and the rasteriser takes corners to the nearest 1/256 pixel, so that one in some dozens
// falls on the neighbouring step. A ray within that of an edge may meet what lies next to it; all others see
// the surface some 1e-3 pixels off, where colours may be rounded to the next code. So a channel may differ
// by kCodes anywhere, and by more in kShare of the pixels, at edges (measured: one in 1000 differs at all,
// one in 70,000 by more).
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/render/support/fields.h"

namespace fettle::render {
namespace {

constexpr int kCodes = 3;
constexpr double kShare = 0.0002;

double part(int c, int r) {
  const double x = c * 0.25, y = r * 0.25;
  double z = 0.02 * x + 0.004 * ((c * 31 + r * 17) % 64);
  if (std::hypot(x - 12, y - 18) < 6) z += 3;
  if (std::hypot(x - 29, y - 19) < 6) z += std::sqrt(36 - std::pow(std::hypot(x - 29, y - 19), 2)) * 0.6;
  if (y > 5 && y < 8) z -= 1.5;
  return z;
}

engine::Version partField(int width = 160, int height = 120) {
  return fieldOf(
      gridOf(width, height, 0.25, 0.25),
      [](int c, int r) { return c > 90 && c < 100 && r < 50 && r > 20 ? kNan : part(c, r); },
      [](int c, int r) { return std::abs(std::hypot(c * 0.25 - 12, r * 0.25 - 18) - 6) < 0.4; });
}

Still decorated(int width, int height) {
  Still still;
  View view;
  view.width = width;
  view.height = height;
  view.azimuth_deg = 330;
  view.elevation_deg = 40;
  still.input = stillInput(view);
  still.input.titles = {"in parts"};
  still.shown.versions = {partField()};
  still.shown.marks = MarksOverlay::kShow;
  return still;
}

void expectSame(const Still& still, int side, const char* what) {
  const Image whole = shoot(*sharedPicture(), still, kPartSide).image;
  const Image parts = shoot(*sharedPicture(), still, side).image;
  ASSERT_EQ(whole.rgba.size(), parts.rgba.size());
  int off = 0;
  for (std::size_t i = 0; i < whole.rgba.size(); i += 4) {
    int worst = 0;
    for (std::size_t k = 0; k < 4; ++k)
      worst = std::max(worst, std::abs(whole.rgba[i + k] - parts.rgba[i + k]));
    off += worst > kCodes;
  }
  EXPECT_LE(off, kShare * static_cast<double>(whole.rgba.size() / 4)) << what << ", parts of " << side;
}

TEST(Parts, JoinToThePictureDrawnAsOneWhateverItShows) {
  for (const int side : {64, 102}) {
    Still still = decorated(481, 300);
    expectSame(still, side, "marks");
    still.input.contours = Contours::kShow;
    still.input.theme = Theme::kDark;
    expectSame(still, side, "contours");
    still.input.view.projection = Projection::kPerspective;
    still.input.view.zoom = 3.0;
    expectSame(still, side, "perspective");
    still.shown.original =
        fieldOf(gridOf(160, 120, 0.25, 0.25), [](int c, int r) { return 0.98 * part(c, r); });
    expectSame(still, side, "deviation");
    still.shown.original = fieldOf(gridOf(160, 120, 0.25, 0.25),
                                   [](int c, int r) { return r > 60 && c < 80 ? kNan : 0.98 * part(c, r); });
    expectSame(still, side, "not compared");
    still.input.decoration = Decoration::kNone;
    still.input.sharpness = Sharpness::kFull;
    expectSame(still, side, "bare");
  }
}

TEST(Parts, JoinWithSeveralFieldsOverlaysAndEyes) {
  Still still = decorated(480, 301);
  still.shown.versions.push_back(partField(200, 90));
  still.input.titles = {"one", "two"};
  expectSame(still, 64, "two fields");
  still.shown.versions[1] = partField();
  still.input.arrangement = Arrangement::kSplit;
  still.input.split = 0.4;
  expectSame(still, 64, "split");
  still.shown.versions.pop_back();
  still.input.overlays.rings = {{29, 19, 4, {1, 1, 1}, 2}};
  appendStylus({{12, 18, 4}, {12, 18, 3}, {0, 0, 2}, true, 1.0}, 1.0, still.input.overlays.lines);
  expectSame(still, 64, "overlays");
  for (const StereoMode mode : {StereoMode::kSideBySide, StereoMode::kAnaglyph}) {
    still.input.stereo.mode = mode;
    still.input.view.width = 481;
    expectSame(still, 64, mode == StereoMode::kAnaglyph ? "anaglyph" : "side by side");
  }
}

// Letters, bars and swatches lie on whole pixels, so that nothing of them is rounded. Of the surface there is next to
// nothing, a few pixels that are rounded as the processor does.
TEST(Parts, DecorationsAreBitIdentical) {
  Still still = decorated(600, 400);
  still.input.view.zoom = 0.01;
  const Image whole = shoot(*sharedPicture(), still).image;
  const Image parts = shoot(*sharedPicture(), still, 50).image;
  still.input.view.centre_x = 4.0;  // the same without the surface where it was
  const Image moved = shoot(*sharedPicture(), still).image;
  ASSERT_EQ(whole.rgba.size(), parts.rgba.size());
  int of_surface = 0;
  for (std::size_t i = 0; i < whole.rgba.size(); i += 4) {
    const bool surface = !std::equal(&whole.rgba[i], &whole.rgba[i] + 4, &moved.rgba[i]);
    of_surface += surface;
    for (std::size_t k = i; k < i + 4; ++k)
      ASSERT_LE(std::abs(whole.rgba[k] - parts.rgba[k]), surface ? kCodes : 0)
          << i / 4 % 600 << ' ' << i / 4 / 600;
  }
  EXPECT_LE(of_surface, 64);
}

// Pages that come on demand are those of each part.
TEST(Parts, OfAFieldThatTheDeviceHoldsAPartOfAreTheSame) {
  LiveOptions options;
  options.validation = Validation::kOn;
  options.memory_budget_bytes = 1'200'000;
  const auto small = LivePicture::create(options);
  ASSERT_TRUE(small) << small.error().line();
  Still still = decorated(400, 300);
  still.shown.marks = MarksOverlay::kHide;
  still.shown.versions = {partField(900, 700)};
  still.input.view.zoom = 2.0;
  const Image whole = shoot(*sharedPicture(), still).image;
  const Shot parts = shoot(**small, still, 64);
  EXPECT_EQ(parts.stats.residency.pages_over_budget, 0);
  int off = 0;
  for (std::size_t i = 0; i < whole.rgba.size(); ++i)
    off += std::abs(whole.rgba[i] - parts.image.rgba[i]) > kCodes;
  EXPECT_LE(off, 3 * kShare * static_cast<double>(whole.rgba.size() / 4));
}

TEST(Parts, APictureHigherThanTheDevicesImagesIsDrawnToItsEnd) {
  // 16384 is what lavapipe draws in one image.
  Still still = decorated(40, 40000);
  still.input.decoration = Decoration::kNone;
  still.input.view.azimuth_deg = 0;
  still.input.view.elevation_deg = 90;
  still.shown.marks = MarksOverlay::kHide;
  still.shown.versions = {fieldOf(gridOf(5, 4001), [](int c, int r) { return r < 2000 ? c : 10 + c; })};
  still.input.range = ValueRange{0, 20};
  const Image image = shoot(*sharedPicture(), still).image;
  ASSERT_EQ(image.rgba.size(), std::size_t{4} * 40 * 40000);
  // Row 0 of the field is the picture's lowest; every row of the picture shows it.
  const std::uint8_t *high = pixel(image, 20, 1000), *low = pixel(image, 20, 39000);
  EXPECT_GT(high[1], low[1]);
  for (int y = 400; y < 39600; y += 97) {
    if (std::abs(y - 20000) < 300) continue;
    EXPECT_NEAR(pixel(image, 20, y)[1], y < 20000 ? high[1] : low[1], 2) << y;
  }
  const auto refused = sharedPicture()->drawAndWait(still.input);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, engine::ErrorKind::kInput);
}

TEST(Parts, APartBesideThePictureOrFromAnOddPixelIsRefused) {
  Still still = decorated(400, 300);
  ASSERT_TRUE(sharedPicture()->update(still.shown));
  for (const Rectangle& part : {Rectangle{390, 0, 20, 20}, {-2, 0, 20, 20}, {1, 0, 20, 20}, {0, 0, 0, 20}}) {
    still.input.part = part;
    Image image;
    const auto drawn = sharedPicture()->draw(still.input, image);
    ASSERT_FALSE(drawn);
    EXPECT_EQ(drawn.error().kind, engine::ErrorKind::kInput);
  }
}

}  // namespace
}  // namespace fettle::render
