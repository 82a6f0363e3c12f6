// Whole pictures against stored ones, tests/render/live/golden/NAME.png.
//
// Tolerance: a channel may differ by 3 codes anywhere (another compiler's rounding in lavapipe's code
// generation), and by more in at most 0.5 % of the pixels (an edge that falls on the other side of a ray). A
// failure leaves NAME.actual.png, NAME.expected.png and NAME.difference.png (differences times 16) in a
// folder that it names.
//
// To accept new pictures after looking at them: FETTLE_UPDATE_GOLDEN=1
// <build>/tests/render/live/render_golden_test
#include <cstdlib>
#include <filesystem>

#include "render/png/png.h"
#include "tests/render/support/fields.h"
#include "tests/support/source_tree.h"

namespace fettle::render {
namespace {

// A small machined part: a tilted plate with a boss, a groove and a dome, dropouts next to the steps,
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

void compareWithGolden(const std::string& name, const Image& actual) {
  const std::string path = tests::inSourceTree("tests/render/live/golden/") + name + ".png";
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

// A picture drawn once.
void compareWithGolden(const std::string& name, const Still& still) {
  LivePicture* picture = sharedPicture();
  ASSERT_NE(picture, nullptr);
  compareWithGolden(name, shoot(*picture, still).image);
}

// A frame of the window.
void compareWithGolden(const std::string& name, const Shown& shown, const FrameInput& input) {
  LiveOptions options;
  options.validation = Validation::kOn;
  const auto picture = LivePicture::create(options);
  ASSERT_TRUE(picture) << picture.error().line();
  ASSERT_TRUE((*picture)->update(shown));
  Image actual;
  // Until all of it is measured, frames are finer than need be.
  std::int64_t left = 1;
  while (left > 0) {
    const auto drawn = (*picture)->draw(input, actual);
    ASSERT_TRUE(drawn);
    left = drawn->upload.pending_tiles;
  }
  for (const std::string& message : (*picture)->validationMessages()) ADD_FAILURE() << message;
  compareWithGolden(name, actual);
}

FrameInput frame(double azimuth_deg, double elevation_deg) {
  FrameInput input;
  input.view.width = 480;
  input.view.height = 300;
  input.view.azimuth_deg = azimuth_deg;
  input.view.elevation_deg = elevation_deg;
  return input;
}

Still small(const engine::Version& field) {
  View view;
  view.width = 480;
  view.height = 300;
  Still still;
  still.shown.versions = {field};
  still.input = stillInput(view);
  return still;
}

TEST(Golden, ObliqueWithMarksAndNoData) {
  Still still = small(part(0.1));
  still.shown.marks = MarksOverlay::kShow;
  still.input.titles = {"part"};
  compareWithGolden("oblique_marks", still);
}

TEST(Golden, SideBySideFromAbove) {
  Still still = small(part(0.3));
  still.shown.versions.push_back(part(0.02));
  still.input.view.azimuth_deg = 0;
  still.input.view.elevation_deg = 90;
  still.input.titles = {"scan", "smoothed"};
  still.input.colouring.map = ColourMap::kCividis;
  compareWithGolden("side_by_side", still);
}

TEST(Golden, DeviationOnDarkInPerspective) {
  Still still = small(part(0.02));
  still.shown.original = part(0.3);
  still.input.view.azimuth_deg = 340;
  still.input.view.projection = Projection::kPerspective;
  still.input.theme = Theme::kDark;
  compareWithGolden("deviation_dark", still);
}

TEST(Golden, GreyWithContourLines) {
  Still still = small(part(0.0));
  still.input.colouring.map = ColourMap::kGrey;
  still.input.contours = Contours::kShow;
  compareWithGolden("grey_contours", still);
}

TEST(Golden, PorcelainWithHoles) {
  Still still = small(part(0.02));
  still.input.form.material = Material::kPorcelain;
  compareWithGolden("material_porcelain", still);
}

TEST(Golden, MetalUnderColoursAndMarks) {
  Still still = small(part(0.02));
  still.shown.marks = MarksOverlay::kShow;
  still.input.form.material = Material::kMetal;
  still.input.form.value_colours = 0.5;
  compareWithGolden("material_colours", still);
}

TEST(Golden, LiveWithMarksHolesAndAStylus) {
  Shown shown;
  shown.versions = {part(0.05)};
  shown.marks = MarksOverlay::kShow;
  FrameInput input = frame(315, 40);
  input.titles = {"part"};
  input.overlays.rings = {{29, 19, 4, {1, 1, 1}, 2}};
  appendStylus({{12, 18, 4}, {12, 18, 3}, {0, 0, 2}, true, 1.0}, 1.0, input.overlays.lines);
  compareWithGolden("live_marks", shown, input);
}

// Without noise: how wide a line is drawn on noise hangs on which neighbours a fragment compares itself with.
TEST(Golden, LiveContoursOnASmoothPart) {
  Shown shown;
  shown.versions = {part(0.0)};
  FrameInput input = frame(330, 55);
  input.contours = Contours::kShow;
  input.colouring.map = ColourMap::kGrey;
  compareWithGolden("live_contours", shown, input);
}

TEST(Golden, LiveDeviationInPerspectiveBesideTheOriginal) {
  Shown shown;
  shown.versions = {part(0.02), part(0.3)};
  shown.original = part(0.3);
  FrameInput input = frame(20, 60);
  input.view.projection = Projection::kPerspective;
  input.theme = Theme::kLight;
  input.titles = {"smooth", "rough"};
  compareWithGolden("live_deviation", shown, input);
}

TEST(Golden, LiveCoarseFromAfar) {
  // Every level of colours, and cells that stand in for walls.
  engine::Grid grid = gridOf(1600, 1200, 0.025, 0.025);
  Shown shown;
  shown.versions = {fieldOf(grid, [](int c, int r) {
    const double x = c * 0.025, y = r * 0.025;
    double z = 0.02 * x + 0.002 * ((c * 31 + r * 17) % 64);
    if (std::hypot(x - 12, y - 18) < 6) z += 3;
    if (y > 5 && y < 8) z -= 1.5;
    return z;
  })};
  FrameInput input = frame(300, 35);
  input.view.zoom = 0.8;
  input.vertex_budget = 16384;
  input.decoration = Decoration::kNone;
  compareWithGolden("live_coarse", shown, input);
}

}  // namespace
}  // namespace fettle::render
