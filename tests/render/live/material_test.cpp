// Materials: the shader against the same function in double precision.
#include <cmath>
#include <set>

#include <glm/geometric.hpp>

#include "render/live/live_plan.h"
#include "render/plan/material.h"
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

double materialCode(double light) {
  const double l = std::clamp(light, 0.0, 1.0);
  return 255.0 * (l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055);
}

engine::Version slopeField(double gx, double gy) {
  return fieldOf(gridOf(80, 60, 0.5, 0.5), [=](int c, int r) { return 0.5 * (gx * c + gy * r); });
}

Still lookedAt(const engine::Version& field, double azimuth_deg, double elevation_deg) {
  View view;
  view.width = 160;
  view.height = 120;
  view.azimuth_deg = azimuth_deg;
  view.elevation_deg = elevation_deg;
  view.vertical_exaggeration = 1.0;
  view.zoom = 2.0;
  Still still;
  still.shown.versions = {field};
  still.input = stillInput(view);
  still.input.decoration = Decoration::kNone;
  still.input.form = {};
  return still;
}

// A plane has one normal, and its middle is in the middle of the picture. Two codes: half a code of rounding, 0.6 of
// the encoder (Vulkan 1.3, 16.1), and the narrowest highlight, of exponent 180 and strength 0.45, changes by 0.0002
// where a normal of single precision is 3e-6 off.
TEST(Materials, AreThoseOfATwinInDoublePrecision) {
  LivePicture* picture = sharedPicture();
  ASSERT_NE(picture, nullptr);
  const glm::dvec2 slopes[] = {{0.0, 0.0}, {0.3, -0.4}, {-0.8, 0.2}, {-0.4, -0.5}, {0.1, 0.6}};
  for (const MaterialRow& row : materials())
    for (const glm::dvec2& slope : slopes)
      for (const auto& [azimuth, elevation] : {std::pair{0.0, 90.0}, {315.0, 45.0}, {70.0, 60.0}}) {
        if (row.material == Material::kNone) continue;
        SCOPED_TRACE(testing::Message() << row.word << ' ' << slope.x << ' ' << slope.y << ' ' << azimuth);
        Still still = lookedAt(slopeField(slope.x, slope.y), azimuth, elevation);
        still.input.form.material = row.material;
        const Image image = shoot(*picture, still).image;
        const ViewAxes axes = axesOf(still.input.view);
        const glm::dvec3 normal = glm::normalize(glm::dvec3(-slope.x, -slope.y, 1.0));
        const glm::dvec3 n{glm::dot(normal, axes.right), glm::dot(normal, axes.up),
                           glm::dot(normal, axes.to_viewer)};
        ASSERT_GT(n.z, 0.05);
        const glm::dvec3 lit =
            glm::dvec3(row.look.body) * materialLight(row.look, n) + materialGloss(row.look, n);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(pixel(image, 80, 60)[k], materialCode(lit[k]), 2.0) << k;
      }
}

// Colours can be read off the bar where the surface is level.
TEST(Materials, LeaveTheColoursOfALevelSurfaceAsTheyAre) {
  LivePicture* picture = sharedPicture();
  ASSERT_NE(picture, nullptr);
  for (const double elevation : {90.0, 60.0, 35.0}) {
    Still still = lookedAt(slopeField(0.0, 0.0), 300.0, elevation);
    still.input.range = ValueRange{-1.0, 2.0};
    const Image plain = shoot(*picture, still).image;
    for (const MaterialRow& row : materials()) {
      still.input.form.material = row.material;
      still.input.form.value_colours = 1.0;
      const Image image = shoot(*picture, still).image;
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(pixel(image, 80, 60)[k], pixel(plain, 80, 60)[k], 2) << row.word << ' ' << elevation;
    }
  }
}

// Of a deviation colours stay, whatever share is chosen.
TEST(Materials, OfADeviationKeepItsColours) {
  LivePicture* picture = sharedPicture();
  ASSERT_NE(picture, nullptr);
  Still still = lookedAt(slopeField(0.0, 0.0), 0.0, 90.0);
  still.shown.original = fieldOf(gridOf(80, 60, 0.5, 0.5), [](int c, int) { return c < 40 ? 0.5 : -0.5; });
  still.input.range = ValueRange{-1.0, 1.0};
  still.input.form.material = Material::kClay;
  const Image image = shoot(*picture, still).image;
  // Blue is lower, red is higher.
  EXPECT_GT(pixel(image, 40, 60)[2], pixel(image, 40, 60)[0] + 40);
  EXPECT_GT(pixel(image, 120, 60)[0], pixel(image, 120, 60)[2] + 40);
}

// Another material is another picture, also over what was drawn; without one there is no pipeline for it.
TEST(Materials, AreDrawnAgainWhenAnotherIsChosen) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(partField()));
  FrameInput input = bare();
  const Image before = drawComplete(*picture, input).image;
  std::set<std::vector<std::uint8_t>> seen{before.rgba};
  for (const MaterialRow& row : materials()) {
    input.form.material = row.material;
    seen.insert(drawComplete(*picture, input).image.rgba);
  }
  EXPECT_EQ(seen.size(), kMaterials);
  input.form.material = Material::kNone;
  EXPECT_EQ(differing(before, drawComplete(*picture, input).image), 0U);
}

// With nothing of the colours in the picture there is no bar that says what they mean.
TEST(Materials, HaveTheBarOfColoursOnlyWithColours) {
  FrameInput input;
  Shown shown;
  shown.versions = {slopeField(0.1, 0.0)};
  const auto bar = [&] {
    const auto plan = planFrame(input, shown, spansOf(shown.versions, shown.original));
    return plan && plan->decorations.colours;
  };
  EXPECT_TRUE(bar());
  input.form.material = Material::kWax;
  EXPECT_FALSE(bar());
  input.form.value_colours = 0.3;
  EXPECT_TRUE(bar());
  input.form.value_colours = 0.0;
  shown.original = slopeField(0.0, 0.1);
  EXPECT_TRUE(bar());
  input.form.value_colours = 1.1;
  EXPECT_FALSE(planFrame(input, shown, spansOf(shown.versions, shown.original)));
}

}  // namespace
}  // namespace fettle::render
