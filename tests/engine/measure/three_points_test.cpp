// Planes through three points: exact on a plane, refused where they say nothing, as sure as is stated.
#include "engine/measure/three_points.h"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/means.h"
#include "engine/measure/form_fit.h"
#include "engine/measure/three_point_errors.h"
#include "tests/engine/measure/fields.h"

namespace fettle::engine {
namespace {

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

// Spacing 1:4 far from the origin, heights in micrometres.
Version unevenly(const Version& field) {
  Grid grid = field.grid();
  grid.spacing_x = 0.1;
  grid.spacing_y = 0.4;
  grid.origin_x = grid.origin_y = 5e6;
  grid.height_unit = {"um", 1e-3};
  return field.withGrid(grid);
}

FittedForm planeOf(const Version& field, const ThreePoints& points, Region region = Region::kAll) {
  JobControl job;
  auto fit = fitNominalForm(field, {FormKind::kPlane, region, false, points}, job);
  EXPECT_TRUE(fit) << fit.error().line();
  return fit ? *std::move(fit) : FittedForm{};
}

std::string refusalOf(const Version& field, const FormChoice& choice) {
  JobControl job;
  const auto fit = fitNominalForm(field, choice, job);
  EXPECT_FALSE(fit);
  if (fit) return {};
  EXPECT_EQ(fit.error().kind, ErrorKind::kInput);
  EXPECT_EQ(fit.error().where, "through");
  EXPECT_FALSE(fit.error().remedy.empty());
  return fit.error().what;
}

TEST(ThreePointPlanes, AreExactOnAPlaneWhateverIsMissingAroundThePoints) {
  // Heights that float has exactly; holes at the points and on one side of them, points between samples.
  const auto z = [](int c, int r) { return 3.0 + 0.25 * c - 0.5 * r; };
  const Version field = unevenly(fieldOf(121, 41, [&](int c, int r) {
    const bool hole = (c == 20 && r == 10) || (c > 97 && r < 12) || (c + 2 * r) % 5 == 0;
    return hole ? kGap : z(c, r);
  }));
  const FittedForm fit = planeOf(field, {{{{2.0, 4.0}, {9.73, 4.31}, {6.0, 14.2}}}, 1.0});
  for (int r = 0; r < 41; ++r)
    for (int c = 0; c < 121; ++c) ASSERT_NEAR(fit.form.heightAt(c, r), z(c, r), 1e-11) << c << ' ' << r;
  ASSERT_TRUE(fit.through);
  EXPECT_GT(fit.through->means[1].samples, 10);
  EXPECT_NEAR(fit.through->slope_x_error, 0.0, 1e-12);
  EXPECT_LT(fit.rms, 1e-11);
  const auto tilt = tiltOf(fit, field.grid());
  ASSERT_TRUE(tilt);
  EXPECT_NEAR(tilt->x_deg, 0.25e-3 / 0.1 * 180.0 / 3.141592653589793, 1e-6);
  EXPECT_NEAR(tilt->y_deg, -0.5e-3 / 0.4 * 180.0 / 3.141592653589793, 1e-6);
  EXPECT_LT(tilt->y_error_deg, 1e-11);
  std::int64_t around = 0;
  for (const ThreePointPlane::Mean& mean : fit.through->means) around += mean.samples;
  EXPECT_EQ(fit.samples, around);
  // One sample each, which says nothing of noise.
  const FittedForm single = planeOf(field, {{{{2.1, 4.0}, {9.0, 4.4}, {6.1, 14.0}}}, 0.05});
  EXPECT_EQ(single.samples, 3);
  EXPECT_TRUE(std::isnan(single.through->slope_x_error));
  EXPECT_NEAR(single.form.heightAt(0, 0), 3.0, 1e-11);
}

TEST(ThreePointPlanes, CountTheSamplesOfTheirRegionAlone) {
  const auto raised = [](int c, int) { return c % 3 == 0; };
  const Version field = fieldOf(
      60, 50, [&](int c, int r) { return 1.0 + 0.5 * c + 0.25 * r + (raised(c, r) ? 64.0 : 0.0); }, raised);
  const ThreePoints points{{{{10.0, 10.0}, {45.0, 12.0}, {30.0, 40.0}}}, 0.0};
  const FittedForm low = planeOf(field, points, Region::kUnmarked);
  const FittedForm high = planeOf(field, points, Region::kMarked);
  EXPECT_NEAR(low.form.heightAt(0, 0), 1.0, 1e-10);
  EXPECT_NEAR(high.form.heightAt(0, 0), 65.0, 1e-10);
  // Five samples around where nothing is said: 81 lie there, a third of them marked.
  EXPECT_EQ(low.samples + high.samples, 3 * 81);
  EXPECT_EQ(refusalOf(fieldOf(60, 50, [](int, int) { return 1.0; }),
                      {FormKind::kPlane, Region::kMarked, false, points})
                .find("no sample counts within 5 mm of 10,10"),
            0U);
}

TEST(ThreePointPlanes, ThatSayNothingAreRefused) {
  const Version field = fieldOf(60, 50, [](int c, int r) { return c > 40 ? kGap : 0.5 * c + r; });
  const auto refusal = [&](std::array<glm::dvec2, 3> at, double radius = 2.0) {
    return refusalOf(field, {.through = ThreePoints{at, radius}});
  };
  EXPECT_NE(refusal({{{5, 5}, {20, 20}, {35, 35}}}).find("nearly on a line"), std::string::npos);
  EXPECT_NE(refusal({{{5, 5}, {20, 20.5}, {35, 35}}}).find("nearly on a line"), std::string::npos);
  EXPECT_NE(refusal({{{5, 5}, {5, 5}, {35, 35}}}).find("nearly on a line"), std::string::npos);
  EXPECT_EQ(refusal({{{5, 5}, {50, 20}, {35, 35}}}), "no sample counts within 2 mm of 50,20");
  EXPECT_EQ(refusal({{{5, 5}, {-30, 20}, {35, 35}}}), "no sample counts within 2 mm of -30,20");
  EXPECT_EQ(refusal({{{5, 5}, {kGap, 20}, {35, 35}}}), "there is no such place or radius");
  EXPECT_EQ(refusal({{{5, 5}, {30, 5}, {5, 35}}}, 1e9), "there is no such place or radius");
  EXPECT_NE(refusalOf(fieldOf(90, 1, [](int c, int) { return 0.1 * c; }),
                      {.through = ThreePoints{{{{10, 0}, {40, 0}, {80, 0}}}, 2.0}})
                .find("nearly on a line"),
            std::string::npos);
  // A fiftieth of the longest distance, 3.8 samples.
  const Version strip = fieldOf(201, 21, [](int c, int r) { return 0.5 * c + r; });
  const auto offTheLine = [](double samples) {
    return ThreePoints{{{{5, 5}, {195, 5}, {100, 5 + samples}}}, 2.0};
  };
  EXPECT_EQ(refusalOf(strip, {.through = offTheLine(3)}),
            "the three points lie nearly on a line: one is 3 mm off the others'");
  EXPECT_NEAR(planeOf(strip, offTheLine(4)).form.heightAt(0, 0), 0.0, 1e-9);
  const ThreePoints good{{{{5, 5}, {30, 8}, {20, 35}}}, 2.0};
  EXPECT_NE(refusalOf(field, {.kind = FormKind::kSphere, .through = good}).find("those of a plane"),
            std::string::npos);
  EXPECT_NE(refusalOf(field, {.robust = true, .through = good}).find("all of their samples"),
            std::string::npos);
}

// Noise in every sample, 1,000 seeds: the slopes are as near to the truth as is stated.
TEST(ThreePointPlanes, AreAsSureAsTheyState) {
  constexpr int kSeeds = 1000;
  const ThreePoints points{{{{1.0, 2.0}, {5.0, 3.0}, {2.5, 12.0}}}, 0.8};
  std::array<std::array<int, 3>, 2> covered{};
  for (int seed = 0; seed < kSeeds; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed + 1));
    std::normal_distribution<double> noise(0.0, 3.0);
    const Version field = unevenly(fieldOf(60, 40, [&](int c, int r) {
      const double n = noise(random);
      return (c * 3 + r) % 11 == 0 ? kGap : 2.0 * c - 5.0 * r + n;
    }));
    const auto plane = planeThrough(field, points, Region::kAll);
    ASSERT_TRUE(plane) << plane.error().line();
    const auto gradient = plane->form.gradient();
    const std::array off{std::abs(gradient.by_column - 2.0) * 1e-3 / 0.1 / plane->slope_x_error,
                         std::abs(gradient.by_row + 5.0) * 1e-3 / 0.4 / plane->slope_y_error};
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t times = 0; times < 3; ++times)
        if (off[k] <= static_cast<double>(times + 1)) ++covered[k][times];
  }
  for (const auto& direction : covered) {
    EXPECT_NEAR(direction[0], 683, 45);
    EXPECT_NEAR(direction[1], 954, 20);
    EXPECT_GE(direction[2], 991);
  }
}

// The same where rows, or columns, are off by three times the noise of a sample; two of the points share rows.
TEST(ThreePointPlanes, AreAsSureAsTheyStateWhereLinesAreOff) {
  constexpr int kSeeds = 400;
  const ThreePoints points{{{{1.0, 2.0}, {5.0, 3.0}, {2.5, 12.0}}}, 0.8};
  for (const bool by_rows : {true, false}) {
    double off_x = 0.0, off_y = 0.0, error_x = 0.0, error_y = 0.0;
    for (int seed = 0; seed < kSeeds; ++seed) {
      std::mt19937 random(static_cast<unsigned>(seed + 1));
      std::normal_distribution<double> normal;
      std::vector<double> off(60);
      for (double& each : off) each = 9.0 * normal(random);
      const Version field = unevenly(fieldOf(60, 40, [&](int c, int r) {
        const double n = 3.0 * normal(random) + off[static_cast<std::size_t>(by_rows ? r : c)];
        return (c * 3 + r) % 11 == 0 ? kGap : 2.0 * c - 5.0 * r + n;
      }));
      auto plane = planeThrough(field, points, Region::kAll);
      ASSERT_TRUE(plane) << plane.error().line();
      addLineErrors(*plane, field, points, Region::kAll, {3e-3, by_rows ? 9e-3 : 0.0, by_rows ? 0.0 : 9e-3});
      const auto gradient = plane->form.gradient();
      off_x += std::pow((gradient.by_column - 2.0) * 1e-3 / 0.1, 2);
      off_y += std::pow((gradient.by_row + 5.0) * 1e-3 / 0.4, 2);
      error_x += std::pow(plane->slope_x_error, 2);
      error_y += std::pow(plane->slope_y_error, 2);
    }
    // The root of a mean square of 400 is known to 3.5 %.
    EXPECT_NEAR(std::sqrt(error_x / off_x), 1.0, 0.12) << by_rows;
    EXPECT_NEAR(std::sqrt(error_y / off_y), 1.0, 0.12) << by_rows;
  }
}

TEST(ThreePointPlanes, AreTheSameOnMeans) {
  const Version field = unevenly(fieldOf(120, 80, [](int c, int r) { return 0.5 * c - 0.25 * r; }));
  const ThreePoints points{{{{2.0, 4.0}, {9.7, 4.3}, {6.0, 24.2}}}, 1.5};
  const Version means = meansOf(field, {0, 0, 120, 80}, 4);
  const FittedForm fit = planeOf(means, points.onMeans(field.grid(), 4));
  // The mean of the first four columns and rows.
  EXPECT_NEAR(fit.form.heightAt(0, 0), 0.5 * 1.5 - 0.25 * 1.5, 1e-5);
  EXPECT_NEAR(fit.form.heightAt(29, 19), 0.5 * 117.5 - 0.25 * 77.5, 1e-5);
  // Five samples, also of the wide ones, where no radius is said.
  EXPECT_DOUBLE_EQ((ThreePoints{points.at_mm}.onMeans(field.grid(), 4).radius_mm), 2.0);
}

}  // namespace
}  // namespace fettle::engine
