// Panels, overlays, places, decorations.
#include <random>

#include "engine/field/live_field.h"
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

TEST(Live, PickAndPixelOfAreInverse) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(partField()));
  for (const FrameInput& input : views()) {
    (void)shoot(*picture, input);
    int hits = 0;
    for (int y = 7; y < input.view.height; y += 31)
      for (int x = 5; x < input.view.width; x += 29) {
        const auto picked = picture->pick(x, y);
        if (!picked) continue;
        ++hits;
        const auto at = picture->pixelOf(picked->panel, picked->position_mm);
        ASSERT_TRUE(at);
        EXPECT_NEAR(at->first, x, 1e-6);
        EXPECT_NEAR(at->second, y, 1e-6);
      }
    EXPECT_GT(hits, 20);
  }
}

TEST(Live, SplitShowsOneVersionOnEachSideOfTheLineAndFourShareACamera) {
  auto picture = makePicture();
  const engine::Version a = partField(), b = fieldOf(gridOf(640, 480, 0.1, 0.1),
                                                     [](int c, int r) { return 0.5 * kPart(c, r); });
  FrameInput input = bare();
  input.view.vertical_exaggeration = 1.0;
  input.range = ValueRange{-3, 9};
  Shown shown;
  shown.versions = {a, b};
  ASSERT_TRUE(picture->update(shown));
  input.arrangement = Arrangement::kSplit;
  input.split = 0.25;
  input.vertex_budget = 1 << 20;
  const Shot split = shoot(*picture, input);
  const auto left = picture->pick(115, 160), right = picture->pick(300, 160);
  ASSERT_TRUE(left && right);
  EXPECT_EQ(left->panel, 0);
  EXPECT_EQ(right->panel, 1);
  input.split = 1.0;
  const Image first = shoot(*picture, input).image;
  input.split = 0.0;
  const Image second = shoot(*picture, input).image;
  for (int y = 0; y < 320; y += 3)
    for (int x = 0; x < 480; x += 3) {
      if (std::abs(x - 120) < 3) continue;
      const Image& one = x < 120 ? first : second;
      ASSERT_TRUE(std::equal(pixel(split.image, x, y), pixel(split.image, x, y) + 3, pixel(one, x, y)))
          << x << ' ' << y;
    }
  shown.versions = {a, b, a, b};
  ASSERT_TRUE(picture->update(shown));
  input.arrangement = Arrangement::kSideBySide;
  const Shot four = shoot(*picture, input);
  const auto corner = picture->pixelOf(0, {32, 24, 0}), opposite = picture->pixelOf(2, {32, 24, 0});
  ASSERT_TRUE(corner && opposite);
  const int down = static_cast<int>(std::lround(opposite->second - corner->second));
  EXPECT_NEAR(opposite->first, corner->first, 1e-9);
  EXPECT_GT(down, 100);
  // The viewport's offset is added to a float: an edge may fall on the other side of a ray.
  int other = 0;
  for (int y = 10; y < 140; ++y)
    for (int x = 0; x < 230; ++x)
      other +=
          !std::equal(pixel(four.image, x, y), pixel(four.image, x, y) + 3, pixel(four.image, x, y + down));
  EXPECT_LT(other, 130 * 230 / 200);
}

TEST(Live, OverlaysAreSeenWhereTheyAreAndHiddenByWhatLiesBefore) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(partField()));
  FrameInput input = bare();
  input.view.azimuth_deg = 0;
  input.view.elevation_deg = 30;
  input.view.vertical_exaggeration = 1.0;
  const Shot plain = shoot(*picture, input);
  // A disc far behind the field's middle and deep under it: only the one on top is seen.
  const glm::dvec3 buried{32, 30, -2};
  const auto at = [&] { return *picture->pixelOf(0, buried); };
  OverlayLine disc{buried, buried, {1, 0, 0}, 1.0F, 9.0F};
  disc.depth = OverlayLine::Depth::kInScene;
  input.overlays.lines = {disc};
  const Shot hidden = shoot(*picture, input);
  EXPECT_EQ(hidden.image.rgba, plain.image.rgba);
  input.overlays.lines[0].depth = OverlayLine::Depth::kOnTop;
  const Shot seen = shoot(*picture, input);
  const std::uint8_t* p = pixel(seen.image, static_cast<int>(at().first), static_cast<int>(at().second));
  EXPECT_EQ(p[0], 255);
  EXPECT_EQ(p[1], 0);
  // A ring on the surface, and a stylus in contact.
  input.overlays.lines.clear();
  input.overlays.rings = {{20, 30, 12, {1, 0, 1}, 3}};
  appendStylus({{30, 20, 9}, {30, 20, 3}, {0, 0, 2}, true, 1.5}, 4.0, input.overlays.lines);
  const Shot all = shoot(*picture, input);
  int magenta = 0;
  for (int i = 0; i < 480 * 320; ++i) {
    const std::uint8_t* q = pixel(all.image, i % 480, i / 480);
    magenta += q[0] > 240 && q[1] < 15 && q[2] > 240;
  }
  EXPECT_GT(magenta, 200);
}

TEST(Live, ALineOnTheFieldIsSeenFromAboveWhereFewVerticesDrawAStepAsASlope) {
  auto picture = makePicture();
  ASSERT_TRUE(
      picture->update(fieldOf(gridOf(640, 480, 0.1, 0.1), [](int c, int) { return c < 317 ? 0.0 : 8.0; })));
  FrameInput input = bare();
  input.view.elevation_deg = 90;
  constexpr double kFrom_mm = 29.0, kStep_mm = 0.1;
  constexpr int kPlaces = 60;
  const auto place = [](int i) {
    const double x = kFrom_mm + i * kStep_mm;
    return glm::dvec3(x, 24.0, x < 31.65 ? 0.0 : 8.0);
  };
  for (int i = 0; i < kPlaces; ++i) {
    OverlayLine disc{place(i), place(i), {1, 0, 0}, 1.0F, 5.0F};
    disc.depth = OverlayLine::Depth::kInScene;
    input.overlays.lines.push_back(disc);
  }
  // From above the error of any vertices is none on the screen.
  for (const auto& [elevation_deg, vertices] : {std::pair(90.0, 4096), {80.0, 65536}}) {
    input.view.elevation_deg = elevation_deg;
    input.vertex_budget = vertices;
    const Shot seen = shoot(*picture, input);
    for (int i = 0; i < kPlaces; ++i) {
      const auto at = picture->pixelOf(0, place(i));
      ASSERT_TRUE(at);
      const std::uint8_t* p = pixel(seen.image, static_cast<int>(at->first), static_cast<int>(at->second));
      EXPECT_TRUE(p[0] > 240 && p[1] < 40) << elevation_deg << ", place " << i;
    }
  }
}

TEST(Live, DecorationsThemesLightAndMapsAreDrawnAndRefusedWhenOutOfRange) {
  auto picture = makePicture();
  FrameInput input;
  input.view.width = 960;
  input.view.height = 600;
  Image image;
  EXPECT_FALSE(picture->draw(input, image));  // nothing to show yet
  ASSERT_TRUE(picture->update(partField()));
  input.titles = {"kPart"};
  const Shot dark = shoot(*picture, input);
  input.light_azimuth_deg = -45;
  const Shot lit = shoot(*picture, input);
  EXPECT_NE(dark.image.rgba, lit.image.rgba);
  for (const auto& wrong : {&FrameInput::error_px, &FrameInput::split, &FrameInput::light_elevation_deg}) {
    FrameInput bad = input;
    bad.*wrong = -1.0;
    const auto refused = picture->draw(bad, image);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, engine::ErrorKind::kInput);
  }
  Shown odd;
  odd.versions = {partField()};
  odd.original = fieldOf(gridOf(8, 8), [](int, int) { return 1; });
  EXPECT_FALSE(picture->update(odd));
  EXPECT_TRUE(picture->draw(input, image));  // what was there still is
}

TEST(Live, FieldsWithoutCellsHolesOnlyAndHugeHeightsAreDrawn) {
  auto picture = makePicture();
  for (const auto& [w, h] : {std::pair{1, 1}, {1, 40}, {40, 1}, {2, 2}, {65, 1}, {64, 64}, {65, 65}}) {
    ASSERT_TRUE(picture->update(fieldOf(gridOf(w, h), [](int c, int r) { return c + r; })));
    EXPECT_GT(shoot(*picture, bare()).stats.patches, 0) << w << " x " << h;
  }
  ASSERT_TRUE(picture->update(fieldOf(gridOf(30, 30), [](int, int) { return kNan; })));
  EXPECT_EQ(shoot(*picture, bare()).stats.patches, 0);
  ASSERT_TRUE(picture->update(fieldOf(gridOf(300, 300), [](int c, int r) {
    return c == 100 && r == 75 ? 1e6 : c == 9 ? -3e30 : 0.1 * (c % 3);
  })));
  EXPECT_LE(shoot(*picture, bare()).stats.vertices, 98304);
}

}  // namespace
}  // namespace fettle::render
