// Whole pictures against stored ones, tests/render/golden/NAME.png.
//
// Tolerance: a channel may differ by 3 codes anywhere (another compiler's rounding in lavapipe's code
// generation), and by more in at most 0.5 % of the pixels (an edge that falls on the other side of a ray). A
// failure leaves NAME.actual.png, NAME.expected.png and NAME.difference.png (differences times 16) in a
// folder that it names.
//
// To accept new pictures after looking at them: FETTLE_UPDATE_GOLDEN=1
// <build>/tests/render/render_golden_test
#include <cstdlib>
#include <filesystem>

#include "tests/render/fields.h"

namespace fettle::render {
namespace {

// A machined part in little: a tilted plate with a boss, a groove and a dome, dropouts beside the steps,
// marks on the boss's edge. Formula only, so that it is the same everywhere.
engine::Version part(double noise_mm) {
  engine::Grid grid = gridOf(160, 120, 0.25, 0.25);
  std::uint32_t state = 12345;
  const auto height = [&](int c, int r) -> double {
    state = state * 1664525U + 1013904223U;
    const double x = c * 0.25, y = r * 0.25;
    double z = 0.02 * x;
    const double boss = std::hypot(x - 12, y - 18), dome = std::hypot(x - 29, y - 19);
    if (boss < 6) z += 3;
    if (boss >= 6 && boss < 7 && x > 12) return kNan;
    if (dome < 6) z += std::sqrt(36 - dome * dome) * 0.6;
    if (y > 5 && y < 8) z -= 1.5;
    return z + noise_mm * (static_cast<double>(state >> 8) / 8388608.0 - 1.0);
  };
  return fieldOf(grid, height,
                 [](int c, int r) { return std::abs(std::hypot(c * 0.25 - 12, r * 0.25 - 18) - 6) < 0.4; });
}

void compareWithGolden(const std::string& name, const PictureSpec& spec) {
  Renderer* renderer = sharedRenderer();
  ASSERT_NE(renderer, nullptr);
  const Image actual = shoot(*renderer, spec).image;
  const std::string path = std::string(FETTLE_SOURCE_DIR) + "/tests/render/golden/" + name + ".png";
  if (const char* update = std::getenv("FETTLE_UPDATE_GOLDEN"); update != nullptr && *update == '1') {
    ASSERT_TRUE(writePng(actual, path));
    return;
  }
  const engine::Result<Image> expected = readPng(path);
  ASSERT_TRUE(expected) << expected.error().line();
  ASSERT_EQ(expected->width, actual.width);
  ASSERT_EQ(expected->height, actual.height);
  Image difference = actual;
  int off = 0;
  for (std::size_t i = 0; i < actual.rgba.size(); i += 4) {
    int worst = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const int d = std::abs(int{actual.rgba[i + k]} - int{expected->rgba[i + k]});
      difference.rgba[i + k] = static_cast<std::uint8_t>(std::min(255, 16 * d));
      worst = std::max(worst, d);
    }
    off += worst > 3;
  }
  if (off <= actual.width * actual.height / 200) return;
  const std::filesystem::path folder = std::filesystem::current_path() / "golden_failures";
  std::filesystem::create_directories(folder);
  EXPECT_TRUE(writePng(actual, (folder / (name + ".actual.png")).string()));
  EXPECT_TRUE(writePng(*expected, (folder / (name + ".expected.png")).string()));
  EXPECT_TRUE(writePng(difference, (folder / (name + ".difference.png")).string()));
  FAIL() << off << " pixels differ from " << path << "; see " << folder;
}

PictureSpec small(const engine::Version& field) {
  PictureSpec spec;
  spec.field = field;
  spec.view.width = 480;
  spec.view.height = 300;
  return spec;
}

TEST(Golden, ObliqueWithMarksAndNoData) {
  PictureSpec spec = small(part(0.1));
  spec.marks = MarksOverlay::kShow;
  spec.title_left = "part";
  compareWithGolden("oblique_marks", spec);
}

TEST(Golden, SideBySideFromAbove) {
  PictureSpec spec = small(part(0.3));
  spec.compare = part(0.02);
  spec.view.azimuth_deg = 0;
  spec.view.elevation_deg = 90;
  spec.title_left = "scan";
  spec.title_right = "smoothed";
  spec.map = ColourMap::kCividis;
  compareWithGolden("side_by_side", spec);
}

TEST(Golden, DeviationOnDarkInPerspective) {
  PictureSpec spec = small(part(0.02));
  spec.deviation_from = part(0.3);
  spec.view.azimuth_deg = 340;
  spec.view.projection = Projection::kPerspective;
  spec.theme = Theme::kDark;
  compareWithGolden("deviation_dark", spec);
}

TEST(Golden, GreyWithContourLines) {
  PictureSpec spec = small(part(0.0));
  spec.map = ColourMap::kGrey;
  spec.contours = Contours::kShow;
  compareWithGolden("grey_contours", spec);
}

}  // namespace
}  // namespace fettle::render
