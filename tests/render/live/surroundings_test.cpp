// Occlusion and cavity from the heights around a point (shaders/surroundings.glsl), against the same in double
// precision.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/field/live_field.h"
#include "render/detail/pick.h"
#include "render/live/live_plan.h"
#include "render/plan/placing.h"
#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

using Surface = std::function<double(int, int)>;

// Heights of a field that colours come from [height units], clipped as they are drawn: every `step`-th sample.
class LevelHeights {
 public:
  LevelHeights(const PanelPlan& panel, Surface height) : panel_(panel), height_(std::move(height)) {
    const glm::dvec2 px = cellPixels(panel.placing, panel.camera);
    while (step_ < 64 && 4 * step_ * std::max(px.x, px.y) <= 1.0) step_ *= 4;
    smooth_ = std::max(px.x, px.y) > 1.5;
    count_ = glm::max((panel.placing.true_size - 1) / step_ + 1, glm::ivec2(2));
  }
  [[nodiscard]] bool smooth() const { return smooth_; }
  [[nodiscard]] double step() const { return step_; }
  [[nodiscard]] glm::ivec2 count() const { return count_; }
  // Empty: a hole, or outside the field.
  [[nodiscard]] std::optional<double> at(glm::ivec2 s) const {
    const std::optional<double> z = stored(s);
    if (!z) return z;
    return std::clamp(*z, panel_.lowest, panel_.highest);
  }
  // Cosine of the tilt of the normal of the light: of the cell, or where cells are large between its corners,
  // each with the mean of the slopes on both sides of it.
  [[nodiscard]] double upright(const glm::dvec2& p) const {
    const glm::ivec2 cell(glm::floor(p));
    const glm::dvec2 f = p - glm::floor(p);
    glm::dvec2 slope(0.0);
    for (int k = 0; k < 2; ++k) {
      const glm::ivec2 along = k == 0 ? glm::ivec2(1, 0) : glm::ivec2(0, 1), across(along.y, along.x);
      for (int side = 0; side < 2; ++side) {
        const glm::ivec2 a = cell + side * across, b = a + along;
        const double inward = *stored(b) - *stored(a);
        const auto corner = [&](const std::optional<double>& outward) {
          return outward && smooth_ ? 0.5 * (inward + *outward) : inward;
        };
        const auto difference = [&](glm::ivec2 from, glm::ivec2 to) -> std::optional<double> {
          if (!stored(from) || !stored(to)) return std::nullopt;
          return *stored(to) - *stored(from);
        };
        const double edge =
            glm::mix(corner(difference(a - along, a)), corner(difference(b, b + along)), f[k]);
        const double share = smooth_ ? f[1 - k] : 0.5;
        slope[k] += (side == 0 ? 1.0 - share : share) * edge;
      }
    }
    slope *= panel_.mm_per_unit / (step() * panel_.placing.spacing);
    return 1.0 / std::sqrt(1.0 + glm::dot(slope, slope));
  }
  // Between samples.
  [[nodiscard]] std::optional<double> at(glm::dvec2 p) const {
    const glm::ivec2 low(glm::floor(p));
    const glm::dvec2 f = p - glm::floor(p);
    const auto a = at(low), b = at(low + glm::ivec2(1, 0)), c = at(low + glm::ivec2(0, 1)), d = at(low + 1);
    if (!a || !b || !c || !d) return std::nullopt;
    return glm::mix(glm::mix(*a, *b, f.x), glm::mix(*c, *d, f.x), f.y);
  }

 private:
  [[nodiscard]] std::optional<double> stored(glm::ivec2 s) const {
    if (s.x < 0 || s.y < 0 || s.x >= count_.x || s.y >= count_.y) return std::nullopt;
    s = glm::min(s * step_, (panel_.placing.true_size - 1) / step_ * step_);
    const double z = height_(s.x, s.y);
    if (std::isnan(z)) return std::nullopt;
    return z;
  }

  const PanelPlan& panel_;
  Surface height_;
  int step_ = 1;
  bool smooth_ = false;
  glm::ivec2 count_{2};
};

struct Twin {
  double hidden = 0.0, hollow = 0.0;
};

// Of the point `p` [steps of the level]; empty where a cell is not whole, or rounding decides which sample is
// the nearest.
std::optional<Twin> twinAt(const LevelHeights& level, const PanelPlan& panel, glm::dvec2 p) {
  const glm::dvec2 f = p - glm::floor(p);
  for (int k = 0; k < 2; ++k)
    if (f[k] < 0.01 || f[k] > 0.99 || std::abs(f[k] - 0.5) < 0.01) return std::nullopt;
  std::optional<double> here = level.at(p);
  if (!here) return std::nullopt;
  const glm::dvec2 step_mm = level.step() * panel.placing.spacing;
  const auto steps = [&](double px, double direction) {
    const glm::dvec2 d = px * direction / panel.camera.pixelsPerMm() / step_mm;
    return glm::clamp(level.smooth() ? d : glm::round(d), 1.0, 30.0);
  };
  const glm::dvec2 along = steps(8.0, 1.0), between = steps(4.0, std::sqrt(0.5));
  const std::array<glm::dvec2, 4> lines{glm::dvec2(along.x, 0), glm::dvec2(0, along.y), between,
                                        glm::dvec2(between.x, -between.y)};
  const glm::dvec2 middle = level.smooth() ? p : glm::round(p);
  std::array<std::optional<double>, 4> mean;
  double lies = *here;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto height = [&](const glm::dvec2& at) {
      return level.smooth() ? level.at(at) : level.at(glm::ivec2(at));
    };
    const std::optional<double> after = height(middle + lines[k]), before = height(middle - lines[k]);
    if (!after || !before) continue;
    mean[k] = 0.5 * (*after + *before);
    // From the nearest sample to the point along the slope of the axes' samples.
    const auto axis = static_cast<int>(k);
    if (axis < 2) lies -= (p - middle)[axis] * 0.5 * (*after - *before) / along[axis];
  }
  Twin twin;
  for (std::size_t k = 0; k < 4; ++k) {
    if (!mean[k]) continue;
    const double tangent = (*mean[k] - lies) * panel.mm_per_unit / glm::length(lines[k] * step_mm);
    const double sine = std::sin(std::atan(tangent));
    twin.hidden += std::max(0.0, sine) / 4;
    twin.hollow += sine / 4;
  }
  const double upright = level.upright(p);
  return Twin{upright * twin.hidden, upright * twin.hollow};
}

double decoded(double code) {
  const double v = code / 255.0;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}
double coded(double light) {
  const double l = std::min(light, 1.0);
  return 255.0 * (l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055);
}

// Every pixel of a map has the light without the terms times the terms. 2.5 codes: each picture rounds by
// half a code and its encoder by 0.6 (Vulkan 1.3, 16.1); heights and places of single precision change a sine
// by less than 1e-3. What is brightened above white ends there.
void expectTerm(const engine::Version& field, const Surface& height, int width, int rows, FormShading form,
                int fewest) {
  LivePicture* picture = sharedPicture();
  ASSERT_NE(picture, nullptr);
  Still still = mapOf(field, width, rows);
  still.input.sharpness = Sharpness::kFull;
  // Of one colour, so that nothing is white without the terms.
  still.input.range = ValueRange{-1e9, 1e10};
  still.input.form = {};
  ASSERT_TRUE(picture->update(still.shown));
  picture->refreshRanges();
  const Image without = drawComplete(*picture, still.input).image;
  still.input.form = form;
  const Image with = drawComplete(*picture, still.input).image;
  const auto plan = planFrame(still.input, still.shown, spansOf(still.shown.versions, {}));
  ASSERT_TRUE(plan);
  const PanelPlan& panel = plan->panels[0];
  const LevelHeights level(panel, height);
  const engine::FieldReader reader = field.reader();
  int seen = 0, changed = 0;
  for (int y = 0; y < with.height; ++y)
    for (int x = 0; x < with.width; ++x) {
      const Ray ray = panel.camera.rayAt({x + 0.5, y + 0.5});
      const glm::dvec2 at = (glm::dvec2(ray.from) - panel.placing.first) / panel.placing.spacing;
      // Through a hole the plate is seen.
      if (!surfaceHeight(reader, at.x * panel.placing.spacing.x, at.y * panel.placing.spacing.y)) continue;
      const glm::dvec2 f = at - glm::floor(at);
      if (std::min({f.x, f.y, 1 - f.x, 1 - f.y}) < 0.01) continue;
      const std::optional<Twin> twin = twinAt(level, panel, at / level.step());
      if (!twin) continue;
      const double factor = (1.0 - form.occlusion * twin->hidden) * (1.0 - form.cavity * twin->hollow);
      for (int k = 0; k < 3; ++k)
        ASSERT_NEAR(pixel(with, x, y)[k], coded(factor * decoded(pixel(without, x, y)[k])), 2.5)
            << x << ' ' << y << ' ' << k << " hidden " << twin->hidden << " hollow " << twin->hollow;
      ++seen;
      changed += std::abs(factor - 1.0) > 0.05;
    }
  EXPECT_GE(seen, fewest);
  if (fewest > 0) {
    EXPECT_GT(changed, fewest / 20);
  }
}

// Steps, a pit, a ridge, noise.
double relief(double x, double y) {
  return (x > 12 ? 1.5 : 0.0) + (std::hypot(x - 6, y - 6) < 3 ? -2.0 : 0.0) +
         0.8 * std::sin(1.7 * y) * (x > 16);
}
Surface reliefOf(double sx, double sy) {
  return [sx, sy](int c, int r) { return relief(sx * c, sy * r) + 0.02 * hash01(c, r); };
}

constexpr FormShading kOccluded{false, 0.8, 0.0}, kCurved{false, 0.0, 0.6}, kBoth{false, 0.5, 0.3};

void expectTerms(const engine::Grid& grid, const Surface& height, int width, const FormShading& form,
                 int fewest) {
  SCOPED_TRACE(testing::Message() << grid.width << " x " << grid.height << " in " << width);
  const int rows = std::max(16, static_cast<int>(std::lround(width * grid.height * grid.spacing_y /
                                                             (grid.width * grid.spacing_x))));
  expectTerm(fieldOf(grid, height), height, width, rows, form, fewest);
}

TEST(Surroundings, OcclusionAndCavityAreThoseOfATwinInDoublePrecision) {
  // Cells of 0.9 pixels, and of three: heights between samples.
  for (const FormShading& form : {kOccluded, kCurved, kBoth})
    for (const int width : {180, 600})
      expectTerms(gridOf(200, 150, 0.1, 0.1), reliefOf(0.1, 0.1), width, form, 10000);
  // Every 4th sample.
  expectTerms(gridOf(1200, 900, 0.02, 0.02), reliefOf(0.02, 0.02), 220, kBoth, 10000);
}

TEST(Surroundings, ColumnsAndRowsMayBeApartByOneAndFour) {
  expectTerms(gridOf(400, 80, 0.1, 0.4), reliefOf(0.1, 0.4), 160, kBoth, 5000);
  expectTerms(gridOf(80, 400, 0.4, 0.1), reliefOf(0.4, 0.1), 900, kBoth, 100000);
}

TEST(Surroundings, HolesHideNothing) {
  const Surface height = [](int c, int r) {
    return std::hypot(c - 150.0, r - 90.0) < 25 || (c % 40 == 0 && r > 100) ? double{kNan}
                                                                            : reliefOf(0.1, 0.1)(c, r);
  };
  for (const int width : {180, 600}) expectTerms(gridOf(200, 150, 0.1, 0.1), height, width, kBoth, 5000);
}

TEST(Surroundings, ASpikeCountsAsHighAsItIsDrawn) {
  const Surface height = [](int c, int r) { return c == 80 && r == 60 ? 1e6 : reliefOf(0.1, 0.1)(c, r); };
  for (const int width : {180, 600}) expectTerms(gridOf(200, 150, 0.1, 0.1), height, width, kBoth, 10000);
}

// Whatever its tilt, the view and the projection: half of two points is the middle.
TEST(Surroundings, APlaneKeepsItsColour) {
  LivePicture* picture = sharedPicture();
  ASSERT_NE(picture, nullptr);
  for (const double slope : {0.0, 0.3, -1.5}) {
    const engine::Version field =
        fieldOf(gridOf(200, 150, 0.1, 0.1), [slope](int c, int r) { return 0.1 * slope * c + 0.02 * r; });
    ASSERT_TRUE(picture->update(field));
    picture->refreshRanges();
    for (FrameInput input : views()) {
      SCOPED_TRACE(testing::Message() << slope << ' ' << input.view.azimuth_deg << ' '
                                      << static_cast<int>(input.view.projection));
      input.view.zoom = 3.0;
      for (const Sharpness sharpness : {Sharpness::kFull, Sharpness::kHalf, Sharpness::kFine}) {
        input.sharpness = sharpness;
        input.form = {};
        const Image without = shoot(*picture, input).image;
        input.form = kBoth;
        const Image with = shoot(*picture, input).image;
        int off = 0;
        for (int y = 140; y < 180; ++y)
          for (int x = 200; x < 280; ++x)
            for (int k = 0; k < 3; ++k)
              off = std::max(off, std::abs(pixel(with, x, y)[k] - pixel(without, x, y)[k]));
        EXPECT_LE(off, 1);
      }
    }
  }
}

TEST(Surroundings, AFieldOfOneRowOrColumnIsDrawn) {
  for (const engine::Grid& grid : {gridOf(300, 1), gridOf(1, 300), gridOf(2, 2)}) {
    LivePicture* picture = sharedPicture();
    Still still = mapOf(fieldOf(grid, [](int c, int r) { return hash01(c, r); }), 200, 160);
    still.input.form = kBoth;
    const Image image = shoot(*picture, still).image;
    still.input.view.zoom = 1e-3;
    EXPECT_GT(drawnPixels(image, shoot(*picture, still).image), 100);
  }
}

// A frame that draws only what a stroke changed equals one that draws everything.
TEST(Surroundings, AStrokeRedrawsEverythingThatSeesIt) {
  for (const bool holed : {false, true}) {
    auto picture = makePicture();
    const engine::Version before =
        holed ? fieldOf(gridOf(640, 480, 0.1, 0.1),
                        [](int c, int r) {
                          return std::hypot(c - 320.0, r - 230.0) < 20 || (c > 630 && r % 9 == 0)
                                     ? double{kNan}
                                     : kPart(c, r);
                        })
              : partField();
    for (const glm::ivec2 at : {glm::ivec2(300, 200), {631, 300}, {2, 2}, {100, 473}})
      for (FrameInput input : views()) {
        SCOPED_TRACE(testing::Message()
                     << holed << ' ' << at.x << ' ' << at.y << ' ' << input.view.azimuth_deg << ' '
                     << static_cast<int>(input.view.projection));
        engine::LiveField live(before, engine::Growth::kAllowed);
        std::vector<float> z(9 * 7);
        for (std::size_t i = 0; i < z.size(); ++i) z[i] = 3.0F + 0.2F * static_cast<float>(i % 5);
        ASSERT_TRUE(live.writeHeights(at.x, at.y, 9, 7, z.data(), 9));
        input.form = kBoth;
        Shown shown;
        shown.versions = {before, before};
        input.arrangement = Arrangement::kSplit;
        ASSERT_TRUE(picture->update(shown));
        (void)drawComplete(*picture, input);
        shown.versions[1] = live.snapshot();
        if (input.view.zoom > 2.0) std::swap(shown.versions[0], shown.versions[1]);
        ASSERT_TRUE(picture->update(shown));
        const Shot part = shoot(*picture, input);
        EXPECT_TRUE(part.stats.continued);
        input.redraw = FrameInput::Redraw::kAll;
        EXPECT_EQ(differing(part.image, shoot(*picture, input).image), 0U);
      }
  }
}

// Parts of a large picture join as without the terms (parts_test.cpp): rounding about another middle moves a
// pixel in a thousand by more than two codes.
TEST(Surroundings, PartsJoinWithoutASeam) {
  LivePicture* picture = sharedPicture();
  ASSERT_NE(picture, nullptr);
  Still still;
  still.shown.versions = {partField()};
  View view;
  view.width = 300;
  view.height = 210;
  still.input = stillInput(view);
  still.input.form = kBoth;
  for (const StereoMode mode : {StereoMode::kOff, StereoMode::kSideBySide}) {
    still.input.stereo.mode = mode;
    const Image whole = shoot(*picture, still).image, parts = shoot(*picture, still, 64).image;
    ASSERT_EQ(whole.rgba.size(), parts.rgba.size());
    EXPECT_LE(unmatched(parts, whole, 0, 2), 300 * 210 / 1000) << static_cast<int>(mode);
  }
}

TEST(Surroundings, OnDemandThePictureIsTheSame) {
  auto tight = makePicture({.budget = 2900000}), whole = makePicture();
  int compared = 0;
  for (const engine::Version& field : {largeField(), holedField()}) {
    ASSERT_TRUE(tight->update(field));
    ASSERT_TRUE(whole->update(field));
    for (const double zoom : {1.0, 3.0, 8.0, 30.0}) {
      FrameInput input = bareAt(zoom, 0.4, 0.6);
      input.form = kBoth;
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

TEST(Surroundings, StrengthsOutsideNoughtToOneAreRefused) {
  auto picture = makePicture();
  ASSERT_TRUE(picture->update(partField(64, 48)));
  for (const FormShading& form : {FormShading{false, 1.1, 0.0}, FormShading{false, -0.1, 0.0},
                                  FormShading{false, 0.0, 1.1}, FormShading{false, double{kNan}, 0.0}}) {
    FrameInput input = bare();
    input.form = form;
    const auto drawn = picture->drawAndWait(input);
    ASSERT_FALSE(drawn);
    EXPECT_NE(drawn.error().line().find("0 to 1"), std::string::npos) << drawn.error().line();
  }
}

}  // namespace
}  // namespace fettle::render
