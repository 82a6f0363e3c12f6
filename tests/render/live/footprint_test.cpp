// Normals over the footprint of a pixel (shaders/footprint.glsl), against the same plane in double precision.
#include <cmath>
#include <numbers>
#include <optional>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "engine/field/live_field.h"
#include "render/live/live_plan.h"
#include "render/plan/colour_map.h"
#include "render/plan/placing.h"
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

using Height = std::function<double(int, int)>;

// The samples that the colours of a picture from above come from: every `step`-th, and how far the outer
// ones of a footprint lie outside a cell. As render/live/live_panels.h chooses them.
struct Samples {
  int step = 1;
  glm::ivec2 outside{1};
};

Samples samplesOf(const PanelPlan& panel) {
  Samples s;
  const glm::dvec2 px = cellPixels(panel.placing, panel.camera);
  while (s.step < 64 && 4 * s.step * std::max(px.x, px.y) <= 1.0) s.step *= 4;
  for (int k = 0; k < 2; ++k) s.outside[k] = s.step * px[k] <= 0.5 ? 2 : 1;
  return s;
}

// Slope at a cell [height units per sample], of the plane by least squares through its footprint; empty where
// the cell has a hole. Plain: all unknowns of the plane in one system of equations.
std::optional<glm::dvec2> slopeAt(const PanelPlan& panel, const Samples& s, const Height& height,
                                  glm::ivec2 cell, glm::ivec2 count) {
  const engine::Grid& grid = panel.field.grid();
  const auto at = [&](glm::ivec2 p) {
    const double z = height(std::min(p.x * s.step, (grid.width - 1) / s.step * s.step),
                            std::min(p.y * s.step, (grid.height - 1) / s.step * s.step));
    return std::isnan(z) ? z : std::clamp(z, panel.lowest, panel.highest);
  };
  for (int k = 0; k < 4; ++k)
    if (std::isnan(at(cell + glm::ivec2(k & 1, k >> 1)))) return std::nullopt;
  glm::dmat3 sums(0.0);
  glm::dvec3 right(0.0);
  for (int k = 0; k < 8; ++k) {
    const bool after_x = (k & 1) != 0, after_y = (k & 2) != 0;
    const glm::ivec2 out = k < 4 ? glm::ivec2(0) : s.outside;
    const glm::ivec2 d(after_x ? 1 + out.x : -out.x, after_y ? 1 + out.y : -out.y), p = cell + d;
    if (p.x < 0 || p.y < 0 || p.x >= count.x || p.y >= count.y || std::isnan(at(p))) continue;
    const glm::dvec3 row(1.0, d);
    sums += glm::outerProduct(row, row);
    right += row * at(p);
  }
  const glm::dvec3 plane = glm::inverse(sums) * right;
  return glm::dvec2(plane.y, plane.z) / double(s.step);
}

double encodedLight(double light) {
  const double l = std::min(light, 1.0);
  return 255.0 * (l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055);
}

// Every pixel has the light of the plane through its footprint: 30 % of it without direction, the rest from
// 45 degrees up over the left upper corner. Two codes: half a code of rounding, 0.6 of the sRGB encoder
// (Vulkan 1.3, 16.1), the rest for single precision. Pixels next to the edge of a cell may lie in the next.
void expectLight(const Still& still, const Image& image, const Height& height, int fewest) {
  const auto plan = planFrame(still.input, still.shown, spansOf(still.shown.versions, {}));
  ASSERT_TRUE(plan);
  const PanelPlan& panel = plan->panels[0];
  const Samples s = samplesOf(panel);
  const glm::ivec2 count = glm::max((panel.placing.true_size - 1) / s.step + 1, glm::ivec2(2));
  const glm::vec3 colour = colourTable(ColourMap::kViridis)[23];
  int seen = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Ray ray = panel.camera.rayAt({x + 0.5, y + 0.5});
      const glm::dvec2 at = (glm::dvec2(ray.from) - panel.placing.first) / panel.placing.spacing;
      if (at.x < 0.02 || at.y < 0.02 || at.x > panel.placing.size.x - 1.02 ||
          at.y > panel.placing.size.y - 1.02)
        continue;
      const glm::dvec2 place = at / double(s.step), low = glm::floor(place), f = place - low;
      if (f.x < 0.02 || f.x > 0.98 || f.y < 0.02 || f.y > 0.98) continue;
      const glm::ivec2 cell = glm::clamp(glm::ivec2(low), glm::ivec2(0), count - 2);
      const auto slope = slopeAt(panel, s, height, cell, count);
      if (!slope) continue;
      // The cells of samples, too: those with a hole are not drawn.
      bool whole = true;
      for (int k = 0; k < 4; ++k)
        whole = whole && !std::isnan(height(std::min(int(at.x) + (k & 1), panel.placing.true_size.x - 1),
                                            std::min(int(at.y) + (k >> 1), panel.placing.true_size.y - 1)));
      if (!whole) continue;
      const glm::dvec2 g = *slope * panel.mm_per_unit / panel.placing.spacing;
      const double up = std::sqrt(0.5), level = 0.5;
      const double along = (g.x * level - g.y * level + up) / std::sqrt(g.x * g.x + g.y * g.y + 1.0);
      const double light = 0.3 + 0.7 * std::max(0.0, along) / up;
      for (int k = 0; k < 3; ++k)
        ASSERT_NEAR(pixel(image, x, y)[k], encodedLight(colour[k] * light), 2.0)
            << x << ' ' << y << ' ' << k << " cell " << cell.x << ' ' << cell.y;
      ++seen;
    }
  EXPECT_GT(seen, fewest);
}

// A map of which every height has the same colour, filtered normals on.
Still filtered(const engine::Version& field, int width, int height) {
  Still still = mapOf(field, width, height);
  still.input.sharpness = Sharpness::kFull;
  still.input.error_px = kFrameErrorPx;
  still.input.range = ValueRange{-1e9, 1e10};
  still.input.form = {.filtered_normals = true};
  return still;
}

// Noise of about the size of the spacing, on a slope.
Height noisy(double spacing) {
  return [spacing](int c, int r) { return spacing * (0.2 * c - 0.1 * r + 0.6 * hash01(c, r)); };
}

void expectFiltered(const engine::Grid& grid, const Height& height, int width, int fewest) {
  SCOPED_TRACE(testing::Message() << grid.width << " x " << grid.height << " in " << width << " pixels");
  LivePicture* picture = sharedPicture();
  ASSERT_NE(picture, nullptr);
  const int rows = std::max(16, static_cast<int>(std::lround(width * grid.height * grid.spacing_y /
                                                             (grid.width * grid.spacing_x))));
  const Still still = filtered(fieldOf(grid, height), width, rows);
  ASSERT_TRUE(picture->update(still.shown));
  picture->refreshRanges();
  expectLight(still, drawComplete(*picture, still.input).image, height, fewest);
}

TEST(Footprint, ThePlaneThroughItIsThatOfATwinInDoublePrecision) {
  // A cell of 1.4 pixels, the largest that is filtered; of 0.9, 0.4; of 0.1 and 0.02: every 4th sample, every
  // 16th.
  for (const int width : {280, 180, 80}) expectFiltered(gridOf(200, 150, 0.1, 0.1), noisy(0.1), width, 1000);
  expectFiltered(gridOf(1000, 800, 0.1, 0.1), noisy(0.1), 100, 1000);
  expectFiltered(gridOf(2000, 1800, 0.1, 0.1), noisy(0.1), 40, 500);
}

TEST(Footprint, ColumnsAndRowsMayBeApartByOneAndFour) {
  expectFiltered(gridOf(400, 80, 0.1, 0.4), noisy(0.1), 120, 1000);
  expectFiltered(gridOf(80, 400, 0.4, 0.1), noisy(0.1), 90, 1000);
}

TEST(Footprint, HolesAndTheRimAreLeftOut) {
  const auto height = [](int c, int r) {
    const bool gap = std::hypot(c - 70.0, r - 50.0) < 20 || hash01(c + 7, r) > 0.9 || (c > 190 && r % 3 == 0);
    return gap ? double{kNan} : noisy(0.1)(c, r);
  };
  expectFiltered(gridOf(200, 150, 0.1, 0.1), height, 180, 500);
  expectFiltered(gridOf(200, 150, 0.1, 0.1), height, 90, 300);
}

TEST(Footprint, ASpikeTiltsOnlyWhatReachesItAndNoFurtherThanItIsDrawn) {
  const auto height = [](int c, int r) { return c == 80 && r == 60 ? 1e6 : noisy(0.1)(c, r); };
  expectFiltered(gridOf(200, 150, 0.1, 0.1), height, 180, 1000);
}

TEST(Footprint, AFlatFieldAndOneOfOneRowOrColumnHaveTheLightOfTheirSlope) {
  expectFiltered(
      gridOf(200, 150, 0.1, 0.1), [](int, int) { return 7.0; }, 180, 1000);
  expectFiltered(gridOf(300, 1, 0.1, 0.1), noisy(0.1), 400, 50);
  expectFiltered(gridOf(2, 2, 0.1, 0.1), noisy(0.1), 16, 0);
}

// What it is for: of a level field with noise, far away, the picture is nearly one colour. The standard
// deviation falls by sqrt(26) (two steps outside: a step is a quarter of a pixel), by less where the light is
// not linear in the slope or is averaged over rays that share samples.
TEST(Footprint, ANoisyPlaneFarAwayIsNearlyOfOneLight) {
  LivePicture* picture = sharedPicture();
  ASSERT_NE(picture, nullptr);
  const auto height = [](int c, int r) { return 0.1 * hash01(c, r); };
  Still still = filtered(fieldOf(gridOf(1600, 1200, 0.1, 0.1), height), 400, 300);
  const auto spread = [&](bool on, Sharpness sharpness) {
    still.input.form.filtered_normals = on;
    still.input.sharpness = sharpness;
    EXPECT_TRUE(picture->update(still.shown));
    const Image image = drawComplete(*picture, still.input).image;
    double sum = 0.0, squares = 0.0;
    int n = 0;
    for (int y = 20; y < 280; ++y)
      for (int x = 20; x < 380; ++x, ++n) {
        const double v = pixel(image, x, y)[1];
        sum += v;
        squares += v * v;
      }
    return std::sqrt(squares / n - sum / n * (sum / n));
  };
  for (const Sharpness sharpness : {Sharpness::kFull, Sharpness::kHalf, Sharpness::kFine}) {
    SCOPED_TRACE(static_cast<int>(sharpness));
    const double before = spread(false, sharpness), after = spread(true, sharpness);
    // Rounding to codes adds a twelfth of a code squared.
    EXPECT_LT(after, before / (sharpness == Sharpness::kFine ? 2.5 : 4.0) + 0.3) << before << ' ' << after;
  }
}

TEST(Footprint, OnDemandThePictureIsTheSame) {
  auto tight = makePicture({.budget = 2900000}), whole = makePicture();
  int compared = 0;
  for (const engine::Version& field : {largeField(), holedField()}) {
    ASSERT_TRUE(tight->update(field));
    ASSERT_TRUE(whole->update(field));
    for (const double zoom : {1.0, 3.0, 8.0, 14.0}) {
      FrameInput input = bareAt(zoom, 0.4, 0.6);
      input.form.filtered_normals = true;
      input.pages = FrameInput::Pages::kAll;
      const Shot a = drawComplete(*tight, input), b = drawComplete(*whole, input);
      EXPECT_TRUE(a.stats.residency.on_demand);
      if (a.stats.residency.pages_over_budget > 0) continue;
      ++compared;
      EXPECT_EQ(differing(a.image, b.image), 0U) << zoom;
    }
  }
  EXPECT_GE(compared, 4);
}

// A frame that draws only what a stroke changed equals one that draws everything.
TEST(Footprint, AStrokeRedrawsEverythingThatReachesIt) {
  auto picture = makePicture();
  const engine::Version before = partField();
  const engine::Version after = fieldOf(gridOf(640, 480, 0.1, 0.1), [](int c, int r) {
    return kPart(c, r) + (c >= 300 && c < 309 && r >= 200 && r < 207 ? 0.5 : 0.0);
  });
  engine::LiveField live(before, engine::Growth::kAllowed);
  std::vector<float> z(9 * 7);
  after.reader().readHeights(300, 200, 9, 7, z.data(), 9);
  ASSERT_TRUE(live.writeHeights(300, 200, 9, 7, z.data(), 9));
  for (FrameInput input : views()) {
    input.form.filtered_normals = true;
    ASSERT_TRUE(picture->update(before));
    (void)drawComplete(*picture, input);
    ASSERT_TRUE(picture->update(live.snapshot()));
    const Shot part = shoot(*picture, input);
    EXPECT_TRUE(part.stats.continued);
    EXPECT_LT(part.stats.redrawn, 0.5);
    input.redraw = FrameInput::Redraw::kAll;
    EXPECT_EQ(differing(part.image, shoot(*picture, input).image), 0U);
  }
}

}  // namespace
}  // namespace fettle::render
