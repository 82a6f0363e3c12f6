// Spheres, cylinders and cones as forms of a field: found, taken out, refused.
#include "engine/measure/form_fit.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <glm/geometric.hpp>

#include "engine/measure/form.h"
#include "engine/measure/form_surface.h"
#include "tests/engine/measure/fields.h"
#include "tests/support/shape_forms.h"

namespace fettle::engine {
namespace {

constexpr double kHoleHere = std::numeric_limits<double>::quiet_NaN();

Result<FittedForm> tried(const Version& field, FormKind kind, bool robust = false,
                         Region region = Region::kAll) {
  JobControl job;
  return fitNominalForm(field, {kind, region, robust}, job);
}

FittedForm found(const Version& field, FormKind kind, bool robust = false, Region region = Region::kAll) {
  auto fit = tried(field, kind, robust, region);
  EXPECT_TRUE(fit) << fit.error().line();
  return fit ? *std::move(fit) : FittedForm{};
}

Version placed(const Version& field, double spacing_x, double spacing_y, LengthUnit unit = {"mm", 1.0}) {
  Grid grid = field.grid();
  grid.spacing_x = spacing_x;
  grid.spacing_y = spacing_y;
  grid.origin_x = grid.origin_y = 5e6;
  grid.height_unit = unit;
  return field.withGrid(grid);
}

// Noise that a seed repeats, standard deviation 1.
double noiseAt(int c, int r) {
  std::mt19937 random(static_cast<unsigned>(c * 7919 + r * 104729 + 1));
  return std::normal_distribution<double>()(random);
}

struct Truth {
  FormKind kind;
  std::function<double(double x, double y)> z;  // [mm]
  double figure;                                // radius [mm] or half angle [rad]
};

// Over 12 x 12 mm: a ball's cap and a bowl, a rod that lies obliquely and a channel, an upright cone and a lying one.
std::vector<Truth> truths() {
  const double s = std::sqrt(0.5);
  return {
      {FormKind::kSphere,
       [](double x, double y) { return std::sqrt(400.0 - std::pow(x - 5.0, 2) - std::pow(y - 7.0, 2)); },
       20.0},
      {FormKind::kSphere,
       [](double x, double y) {
         return 30.0 - std::sqrt(900.0 - std::pow(x - 6.0, 2) - std::pow(y - 2.0, 2));
       },
       30.0},
      {FormKind::kCylinder, [s](double x, double y) { return std::sqrt(225.0 - std::pow(s * (x - y), 2)); },
       15.0},
      {FormKind::kCylinder, [](double x, double) { return -std::sqrt(225.0 - std::pow(x - 6.0, 2)); }, 15.0},
      {FormKind::kCone,
       [](double x, double y) { return 50.0 - std::hypot(x - 6.5, y + 9.0) / std::tan(0.6); }, 0.6},
      // Its apex 60 mm to the left, its axis along x.
      {FormKind::kCone,
       [](double x, double y) {
         return std::sqrt(std::pow((x + 60.0) * std::tan(0.2), 2) - std::pow(y - 6.0, 2));
       },
       0.2},
  };
}

double figureOf(const FittedForm& fit) {
  return fit.form.shape()->shape == FormShape::kCone ? fit.form.shape()->halfAngle()
                                                     : fit.form.shape()->radius();
}

TEST(ShapeForms, AreFoundAndTakenOutOfExactHeights) {
  JobControl job;
  for (const Truth& truth : truths())
    for (const double level : {0.0, -1000.0}) {
      const Version field = placed(
          fieldOf(121, 121, [&](int c, int r) { return level + truth.z(0.1 * c, 0.1 * r); }), 0.1, 0.1);
      const FittedForm fit = found(field, truth.kind);
      EXPECT_EQ(infoOf(fit.form).kind, truth.kind);
      EXPECT_EQ(fit.samples, 121 * 121);
      EXPECT_EQ(fit.beyond, 0);
      // Heights are rounded to float: a standard deviation of 0.29 of 2^-23 of up to 64 or 1024, and the fit averages over
      // 14,641 of them.
      const double rounding = std::ldexp(0.29, level == 0.0 ? -18 : -14);
      EXPECT_LT(fit.rms, 2.0 * rounding) << static_cast<int>(truth.kind);
      EXPECT_NEAR(figureOf(fit) / truth.figure, 1.0, 200.0 * rounding) << static_cast<int>(truth.kind);
      // What is left is what is left: the form of the layer and of heights, and of a picture, are one.
      const auto without = withoutForm(field, fit.form, job);
      const auto surface = formSurface(field.grid(), fit.form, nullptr, job);
      ASSERT_TRUE(without && surface);
      for (int k = 0; k < 121; k += 8) {
        EXPECT_LT(std::abs(without->reader().heightAt(k, 120 - k)), 8.0 * rounding);
        EXPECT_EQ(surface->reader().heightAt(k, 120 - k), static_cast<float>(fit.form.heightAt(k, 120 - k)));
      }
    }
}

// Noise, a step over a fifth of the field, spikes of 1e6 and holes, spacing 1:4, heights in micrometres.
TEST(ShapeForms, AreFoundThroughStepsSpikesAndHoles) {
  for (const Truth& truth : truths()) {
    const Version field = placed(fieldOf(121, 31,
                                         [&](int c, int r) {
                                           double z = 1e3 * truth.z(0.1 * c, 0.4 * r) + 2.0 * noiseAt(c, r);
                                           if (c < 40 && r < 20) z += 400.0;
                                           if ((c * 31 + r * 17) % 101 == 0) z = c % 2 == 0 ? 1e6 : -1e6;
                                           return (c + 3 * r) % 13 == 0 ? kHoleHere : z;
                                         }),
                                 0.1, 0.4, {"um", 1e-3});
    const FittedForm fit = found(field, truth.kind, true);
    ASSERT_TRUE(fit.fit);
    // Three standard errors as they are stated.
    const ShapeFit::Errors errors = fit.fit->errors();
    const double error = truth.kind == FormKind::kCone ? errors.half_angle : errors.radius;
    EXPECT_NEAR(figureOf(fit), truth.figure, 4.0 * error) << static_cast<int>(truth.kind);
    EXPECT_LT(error, 0.1 * truth.figure);
    EXPECT_GT(fit.fit->left_out, 121 * 31 / 10);
    // The shape where nothing stands on it, to the noise over some thousand samples, at the border more.
    double worst = 0.0;
    for (int r = 0; r < 31; ++r)
      for (int c = 0; c < 121; ++c)
        worst = std::max(worst, std::abs(fit.form.heightAt(c, r) - 1e3 * truth.z(0.1 * c, 0.4 * r)));
    EXPECT_LT(worst, 1.0) << static_cast<int>(truth.kind);
    // Steps and spikes are not taken for it without robustness, either: said by what is left.
    EXPECT_GT(fit.rms, 1e4);
  }
}

// A ball on a plate: marks choose it; outside its equator the plane through it goes on.
TEST(ShapeForms, OfMarkedSamplesGoOnBeyondTheirOutline) {
  const auto onBall = [](int c, int r) { return std::hypot(c - 50.0, r - 40.0) < 25.0; };
  const Version field = fieldOf(
      101, 81,
      [&](int c, int r) {
        return onBall(c, r) ? 10.0 + std::sqrt(900.0 - std::pow(c - 50.0, 2) - std::pow(r - 40.0, 2)) : 10.0;
      },
      onBall);
  const FittedForm fit = found(field, FormKind::kSphere, false, Region::kMarked);
  EXPECT_NEAR(fit.form.shape()->radius(), 30.0, 1e-5);
  EXPECT_EQ(fit.beyond, 0);
  EXPECT_NEAR(fit.form.heightAt(0, 0), 10.0, 1e-5);
  JobControl job;
  const auto without = withoutForm(field, fit.form, job);
  ASSERT_TRUE(without);
  for (int r = 0; r < 81; ++r)
    for (int c = 0; c < 101; ++c) {
      const float z = without->reader().heightAt(c, r);
      ASSERT_TRUE(std::isfinite(z));
      if (onBall(c, r) || std::hypot(c - 50.0, r - 40.0) > 31.0) {
        ASSERT_NEAR(z, 0.0, 1e-4);
      }
    }
  // The plate as well: nearly all of it lies beyond the outline.
  const Version plate = fieldOf(61, 55, [&](int c, int r) {
    const double square = 900.0 - std::pow(c - 30.0, 2) - std::pow(r - 27.0, 2);
    return 10.0 + (square > 275.0 ? std::sqrt(square) : 0.0);
  });
  const FittedForm all = found(plate, FormKind::kSphere, true);
  EXPECT_NEAR(all.form.shape()->radius(), 30.0, 1e-4);
  std::int64_t beyond = 0;
  for (int r = 0; r < 55; ++r)
    for (int c = 0; c < 61; ++c) beyond += std::hypot(c - 30.0, r - 27.0) > 30.0 ? 1 : 0;
  EXPECT_GT(beyond, 200);
  EXPECT_NEAR(static_cast<double>(all.beyond), static_cast<double>(beyond), 4.0);
}

TEST(ShapeForms, ThatSamplesDoNotDetermineAreRefused) {
  for (const FormKind kind : {FormKind::kSphere, FormKind::kCylinder, FormKind::kCone})
    for (const bool robust : {false, true}) {
      const auto refusal = [&](const Version& field, Region region = Region::kAll) {
        const auto fit = tried(field, kind, robust, region);
        EXPECT_FALSE(fit) << static_cast<int>(kind) << robust;
        if (fit) return std::string();
        EXPECT_EQ(fit.error().kind, ErrorKind::kInput);
        return fit.error().what;
      };
      EXPECT_EQ(refusal(fieldOf(20, 20, [](int, int) { return kHoleHere; })), "every sample is a hole");
      EXPECT_NE(refusal(fieldOf(70, 1, [](int c, int) { return 0.01 * c * c; })).find("do not determine"),
                std::string::npos);
      EXPECT_NE(refusal(fieldOf(70, 50, [](int, int) { return 3.0; })).find("do not determine"),
                std::string::npos);
      EXPECT_NE(
          refusal(fieldOf(70, 50, [](int c, int r) { return 0.1 * c - 0.2 * r; })).find("do not determine"),
          std::string::npos);
      EXPECT_NE(refusal(fieldOf(
                            70, 50, [](int c, int r) { return 1.0 * c * r; },
                            [](int c, int r) { return r == 20 && c < 3; }),
                        Region::kMarked)
                    .find("3 samples"),
                std::string::npos);
      EXPECT_EQ(refusal(fieldOf(20, 20, [](int, int) { return 1.0; }), Region::kMarked),
                "nothing is marked that has a height");
    }
}

TEST(ShapeForms, ThatStandUprightAreRefused) {
  ShapeFit rod;
  rod.shape.kind = ShapeKind::kCylinder;
  rod.scale = 10.0;
  rod.surface.ring = -0.5;
  Grid grid;
  grid.width = grid.height = 50;
  // Its axis along z: the normal lies in the plane.
  rod.surface.radial = {1.0, 0.0, 0.0};
  rod.surface.axial = {0.0, 0.0, 1.0};
  const auto refused = formOfShape(rod, grid);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().what.find("too steep"), std::string::npos);
  rod.surface.radial = {0.0, 0.0, -1.0};
  rod.surface.axial = {1.0, 0.0, 0.0};
  EXPECT_TRUE(formOfShape(rod, grid));
}

TEST(ShapeForms, HaveTheSameBitsForAnyNumberOfThreads) {
  const Truth truth = truths()[2];
  const Version field = placed(
      fieldOf(200, 150, [&](int c, int r) { return truth.z(0.06 * c, 0.08 * r) + 1e-3 * noiseAt(c, r); }),
      0.06, 0.08);
  const FittedForm fit = found(field, truth.kind, true);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const FittedForm again = found(field, truth.kind, true);
  EXPECT_EQ(fit.form, again.form);
  EXPECT_EQ(fit.rms, again.rms);
}

// A polynomial over the field already: the surface is the difference.
TEST(ShapeForms, ASurfaceOverAnotherFormIsWhatTheyDifferBy) {
  Grid grid;
  grid.width = 130;
  grid.height = 70;
  const NominalForm plane = PolynomialForm{1, 130, 70, 3.0, {0.5, 0.25, -0.125}};
  const NominalForm sphere = someShape(grid, FormShape::kSphere, 2.0, 4);
  JobControl job;
  const auto surface = formSurface(grid, sphere, &plane, job);
  ASSERT_TRUE(surface);
  EXPECT_EQ(job.total(), 3U * 2U);
  EXPECT_EQ(job.done(), job.total());
  std::vector<double> a(70 * 65), b(70 * 65);
  for (int c : {0, 64, 129}) {
    const SampleRect rect{c / 64 * 64, 0, std::min(64, 130 - c / 64 * 64), 64};
    sphere.readHeights(rect, a.data(), 65);
    plane.readHeights(rect, b.data(), 65);
    for (int r = 0; r < 64; r += 9) {
      const auto k = static_cast<std::size_t>(65 * r + c - rect.column);
      EXPECT_EQ(surface->reader().heightAt(c, r), static_cast<float>(a[k] - b[k]));
    }
  }
  JobControl cancelled_job;
  cancelled_job.cancel();
  EXPECT_EQ(formSurface(grid, sphere, nullptr, cancelled_job).error().kind, ErrorKind::kCancelled);
}

TEST(FormKinds, AreNamedOnceEach) {
  for (const FormInfo& info : formInfos()) {
    EXPECT_EQ(formNamed(info.word), &info);
    EXPECT_EQ(info.degree >= 0, !info.shape.has_value());
  }
  EXPECT_EQ(formNamed("torus"), nullptr);
  EXPECT_EQ(formNamed("none"), nullptr);
  for (const Region region : {Region::kAll, Region::kMarked, Region::kUnmarked})
    EXPECT_EQ(regionNamed(wordOf(region)), region);
  EXPECT_FALSE(regionNamed("measured"));
}

TEST(FormKinds, APolynomialWithOpenTermsIsRefusedByTheirNames) {
  const auto holed = [](auto&& has) {
    return fieldOf(30, 30, [has](int c, int r) { return has(c, r) ? 0.25 * (c * c - r) : kHoleHere; });
  };
  const auto why = [](const Version& field, FormKind kind) {
    const auto fit = tried(field, kind);
    return fit ? fit->open : fit.error().line();
  };
  const Version six = holed([](int c, int r) { return c >= 10 && c < 13 && r >= 4 && r < 6; });
  EXPECT_NE(
      why(six, FormKind::kPolynomial5).find("6 samples decide 6 of the 21 terms of a polynomial of degree 5"),
      std::string::npos)
      << why(six, FormKind::kPolynomial5);
  EXPECT_NE(why(six, FormKind::kPolynomial2)
                .find("5 of the 6 terms of a polynomial of degree 2 and leave y^2 open"),
            std::string::npos)
      << why(six, FormKind::kPolynomial2);
  EXPECT_EQ(why(six, FormKind::kPlane), "");
  const Version row = holed([](int c, int r) { return r == 7 && c < 9; });
  EXPECT_EQ(why(row, FormKind::kPlane), "9 samples decide 2 of the 3 terms of a plane and leave y open");
  // A field of one row has nothing across it.
  const Version alone = fieldOf(30, 1, [](int c, int) { return 0.25 * c * c; });
  for (const FormKind kind : {FormKind::kPlane, FormKind::kPolynomial2, FormKind::kPolynomial5})
    EXPECT_EQ(why(alone, kind), "");
  EXPECT_LT(found(alone, FormKind::kPolynomial2).rms, 1e-5);
}

TEST(FormKinds, SayWhereAPolynomialOfARegionLeavesTheField) {
  // Noise of 1e-3 in a strip of a tenth of a wavy field: a bend that is found in it goes far off elsewhere.
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 1e-3);
  const Version strip = fieldOf(
      100, 40, [&](int c, int r) { return std::sin(0.1 * c) + 0.01 * r + noise(random); },
      [](int c, int) { return c < 10; });
  const auto said = [&](Region region, FormKind kind) {
    FormChoice choice;
    choice.kind = kind;
    choice.region = region;
    JobControl job;
    const auto fit = fitNominalForm(strip, choice, job);
    EXPECT_TRUE(fit) << fit.error().line();
    return fit ? fit->leaves : "";
  };
  EXPECT_NE(said(Region::kMarked, FormKind::kPolynomial5).find("poly5 reaches from "), std::string::npos)
      << said(Region::kMarked, FormKind::kPolynomial5);
  EXPECT_EQ(said(Region::kMarked, FormKind::kMean), "");
  EXPECT_EQ(said(Region::kUnmarked, FormKind::kPolynomial2), "");
  EXPECT_EQ(said(Region::kAll, FormKind::kPolynomial5), "");
}

}  // namespace
}  // namespace fettle::engine
