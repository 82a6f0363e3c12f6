// The shaders against a twin in double precision.
#include <cmath>
#include <numbers>

#include "render/live/live_plan.h"
#include "render/plan/colour_map.h"
#include "tests/render/support/fields.h"

namespace fettle::render {
namespace {

constexpr double kSx = 0.5, kSy = 0.8;
constexpr int kWidth = 200, kHeight = 90;
constexpr double kSlopeX = 0.21, kSlopeY = -0.13;  // mm a mm

double planeHeight(double c, double r) {
  return 3.0 + kSlopeX * kSx * c + kSlopeY * kSy * r;
}

double encoded(double light) {
  const double l = std::min(light, 1.0);
  return 255.0 * (l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055);
}

// Light: 45 degrees up, from the upper left of a picture with azimuth `a`; 0.3 of it without direction; a
// level surface keeps its colour.
double shade(double gx, double gy, double azimuth_deg) {
  const double a = azimuth_deg * std::numbers::pi / 180;
  const double h = std::sqrt(0.5) * std::sqrt(0.5);
  const double lx = h * (-std::cos(a) - std::sin(a)), ly = h * (-std::sin(a) + std::cos(a)),
               lz = std::sqrt(0.5);
  const double n = std::sqrt(gx * gx + gy * gy + 1);
  return 0.3 + 0.7 * std::max(0.0, (-gx * lx - gy * ly + lz) / n) / lz;
}

// Checks a grid of pixels of a picture of the plane. Tolerance of 2 codes: half a code of rounding; 1/256
// pixel of the rasteriser's fixed-point corners and 1e-4 of float interpolation are 0.02 samples and with 256
// colours over 200 samples less than 0.1 code; the sRGB encoder may be off by 0.6 code (Vulkan 1.3, 16.1);
// one code of slack, the mean of four rays included.
void comparePlane(const Still& still, const Image& image, const PicturePlan& plan) {
  const Camera& camera = plan.panels[0].camera;
  const ColourTable& table = colourTable(ColourMap::kViridis);
  const double light = shade(kSlopeX, kSlopeY, still.input.view.azimuth_deg);
  int seen = 0;
  for (int y = 3; y < image.height; y += 11)
    for (int x = 3; x < image.width; x += 13) {
      const Ray ray = camera.rayAt({x + 0.5, y + 0.5});
      // Where the ray meets the plane: scene coordinates are centred, z counted from the middle of the range.
      const double mid = 0.5 * (planeHeight(0, kHeight - 1) + planeHeight(kWidth - 1, 0));
      const auto above = [&](double t) {
        const glm::dvec3 p = ray.from + t * ray.along;
        return p.z + mid - planeHeight(p.x / kSx + 0.5 * (kWidth - 1), p.y / kSy + 0.5 * (kHeight - 1));
      };
      const double t = above(0) / (above(0) - above(1));
      const glm::dvec3 p = ray.from + t * ray.along;
      const double c = p.x / kSx + 0.5 * (kWidth - 1), r = p.y / kSy + 0.5 * (kHeight - 1);
      if (c < 2 || r < 2 || c > kWidth - 3 || r > kHeight - 3) continue;
      const glm::vec3 colour = mapped(table, planeHeight(c, r), plan.range);
      for (int k = 0; k < 3; ++k)
        ASSERT_NEAR(pixel(image, x, y)[k], encoded(colour[k] * light), 2.0) << x << ' ' << y << ' ' << k;
      ++seen;
    }
  EXPECT_GT(seen, 100);
}

engine::Result<PicturePlan> planOf(const Still& still) {
  return planFrame(still.input, still.shown, spansOf(still.shown.versions, still.shown.original));
}

class PlaneShading : public testing::TestWithParam<std::tuple<double, double, double, Projection>> {};

TEST_P(PlaneShading, EveryPixelHasTheColourAndLightOfItsHeight) {
  LivePicture* picture = sharedPicture();
  ASSERT_NE(picture, nullptr);
  Still still = mapOf(fieldOf(gridOf(kWidth, kHeight, kSx, kSy), planeHeight), 420, 360);
  const auto& [azimuth, elevation, error_px, projection] = GetParam();
  still.input.view.azimuth_deg = azimuth;
  still.input.view.elevation_deg = elevation;
  still.input.view.projection = projection;
  still.input.error_px = error_px;
  const engine::Result<PicturePlan> plan = planOf(still);
  ASSERT_TRUE(plan);
  comparePlane(still, shoot(*picture, still).image, *plan);
}

INSTANTIATE_TEST_SUITE_P(Views, PlaneShading,
                         testing::Values(std::tuple{0.0, 90.0, 0.25, Projection::kOrthographic},
                                         std::tuple{315.0, 45.0, 0.25, Projection::kOrthographic},
                                         // Geometry as coarse as it gets, colours exact all the same.
                                         std::tuple{120.0, 60.0, 12.0, Projection::kOrthographic},
                                         std::tuple{20.0, 50.0, 1.0, Projection::kPerspective}));

// Corners of the picture of the map are corners of the field: a bump at a known sample is seen at its pixel.
TEST(Shading, ASampleIsSeenAtThePixelTheCameraNames) {
  LivePicture* picture = sharedPicture();
  ASSERT_NE(picture, nullptr);
  Still still =
      mapOf(fieldOf(gridOf(64, 64), [](int c, int r) { return c == 50 && r == 9 ? 1.0 : 0.0; }), 300, 300);
  still.input.range = ValueRange{0, 1};
  const Image image = shoot(*picture, still).image;
  const engine::Result<PicturePlan> plan = planOf(still);
  const glm::dvec2 at = plan->panels[0].camera.pixelOf({50 - 31.5, 9 - 31.5, 0});
  const std::uint8_t* peak = pixel(image, static_cast<int>(at.x), static_cast<int>(at.y));
  // At most half a pixel, a ninth of a cell, off in x and in y: above 0.79 of the peak, where viridis has red
  // 134 and shading takes up to a tenth.
  EXPECT_GT(peak[0], 120);
  EXPECT_LT(pixel(image, static_cast<int>(at.x), 299 - static_cast<int>(at.y))[0], 90);
}

TEST(Shading, HolesAreGreyMarksAreTintedAndDeviationsAreSigned) {
  LivePicture* picture = sharedPicture();
  ASSERT_NE(picture, nullptr);
  const auto height = [](int c, int r) { return c >= 10 && c < 30 && r >= 10 && r < 30 ? kNan : 5.0F; };
  const engine::Version before = fieldOf(gridOf(100, 100), height);
  const engine::Version after = fieldOf(
      gridOf(100, 100),
      [&](int c, int r) {
        return height(c, r) + (c >= 60 && r < 40 ? 2.0 : 0.0) - (c >= 60 && r >= 60 ? 2.0 : 0.0);
      },
      [](int c, int r) { return c >= 10 && c < 30 && r >= 60 && r < 90; });
  Still still = mapOf(after, 200, 200);
  still.shown.marks = MarksOverlay::kShow;
  still.input.marks_opacity = 1.0;
  still.shown.original = before;
  still.input.range = ValueRange{-2, 2};
  const engine::Result<PicturePlan> plan = planOf(still);
  const Image image = shoot(*picture, still).image;
  const auto at = [&](double c, double r) {
    const glm::dvec2 p = plan->panels[0].camera.pixelOf({c - 49.5, r - 49.5, 0});
    return pixel(image, static_cast<int>(p.x), static_cast<int>(p.y));
  };
  const ColourTable& table = colourTable(ColourMap::kDiverging);
  const auto expect = [&](const std::uint8_t* got, const glm::vec3& light, const char* what) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(got[k], encoded(light[k]), 1.6) << what << ' ' << k;
  };
  expect(at(20, 20), plan->palette.no_data, "hole");
  expect(at(20, 75), plan->palette.marks, "mark");
  expect(at(80, 20), table.back(), "raised");
  expect(at(80, 80), table.front(), "lowered");
  expect(at(45, 50), mapped(table, 0.0, {-2, 2}), "untouched");
}

}  // namespace
}  // namespace fettle::render
