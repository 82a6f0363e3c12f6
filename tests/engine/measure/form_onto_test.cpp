// Forms that are moved in space with their field, against points of the old form, moved.
#include "engine/measure/form_onto.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "tests/support/shape_forms.h"

namespace fettle::engine {
namespace {

Grid ontoGrid(int width, int height, double sx, double sy, LengthUnit unit = {"mm", 1.0}) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = sx;
  grid.spacing_y = sy;
  grid.height_unit = unit;
  return grid;
}

RigidMotion ontoMotion(const glm::dvec3& shift, double tilt_x_deg, double tilt_y_deg, double rotation_deg) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  RigidMotion motion;
  motion.centre = {4.0, 3.0, 20.0};
  return motion.then(shift, {tilt_x_deg * kDegree, 0.0, 0.0})
      .then({}, {0.0, tilt_y_deg * kDegree, 0.0})
      .then({}, {0.0, 0.0, rotation_deg * kDegree});
}

const Grid kOwnGrid = ontoGrid(90, 70, 0.1, 0.12, {"um", 1e-3});
const Grid kOntoGrid = ontoGrid(110, 100, 0.08, 0.08);

PolynomialForm ontoPolynomial(int degree, double size) {
  std::mt19937 random(static_cast<unsigned>(degree) + 11);
  PolynomialForm form{degree, kOwnGrid.width, kOwnGrid.height, 20e3, {}};
  for (int k = 0; k < PolynomialForm::terms(degree); ++k)
    form.coefficients.push_back(size * (static_cast<double>(random()) * 0x1p-31 - 1.0));
  return form;
}

// How far points of the old form, moved, are from the moved one above or below, over the samples of kOntoGrid [mm].
double farthestOff(const NominalForm& form, const NominalForm& moved, const RigidMotion& motion) {
  double most = 0.0;
  int points = 0;
  for (int r = 0; r < kOwnGrid.height; r += 3)
    for (int c = 0; c < kOwnGrid.width; c += 3) {
      const glm::dvec3 p = motion.moved({c * kOwnGrid.spacingXMm(), r * kOwnGrid.spacingYMm(),
                                         kOwnGrid.height_unit.mm * form.heightAt(c, r)});
      const double column = p.x / kOntoGrid.spacingXMm(), row = p.y / kOntoGrid.spacingYMm();
      if (column < 0.0 || row < 0.0 || column > kOntoGrid.width - 1 || row > kOntoGrid.height - 1) continue;
      ++points;
      most = std::max(most, std::abs(p.z - kOntoGrid.height_unit.mm * moved.heightAt(column, row)));
    }
  EXPECT_GT(points, 100);
  return most;
}

TEST(FormOnto, PolynomialsAreExactUntilTheyAreTilted) {
  const RigidMotion level = ontoMotion({0.7, -0.4, 0.35}, 0.0, 0.0, 8.0);
  for (int degree = 0; degree <= 5; ++degree) {
    const NominalForm form = ontoPolynomial(degree, 50.0);
    const auto moved = formOnto(form, kOwnGrid, level, kOntoGrid);
    ASSERT_TRUE(moved);
    EXPECT_EQ(moved->form.polynomial()->degree, degree);
    EXPECT_EQ(moved->off_mm, 0.0);
    EXPECT_LT(farthestOff(form, moved->form, level), 1e-12) << degree;
  }
}

TEST(FormOnto, APlaneStaysOneHoweverItIsTilted) {
  for (const double tilt : {0.3, 5.0, 30.0})
    for (int degree = 0; degree <= 1; ++degree) {
      const RigidMotion motion = ontoMotion({0.2, 0.1, -1.0}, tilt, -0.5 * tilt, 20.0);
      const NominalForm form = ontoPolynomial(degree, 200.0);
      const auto moved = formOnto(form, kOwnGrid, motion, kOntoGrid);
      ASSERT_TRUE(moved);
      EXPECT_EQ(moved->form.polynomial()->degree, 1);
      EXPECT_EQ(moved->off_mm, 0.0);
      EXPECT_LT(farthestOff(form, moved->form, motion), 1e-12);
    }
}

// What is stated is what points say, which lie elsewhere.
TEST(FormOnto, ATiltedPolynomialStatesHowFarItIsOff) {
  for (int degree = 2; degree <= 5; ++degree)
    for (const double tilt : {0.1, 1.0}) {
      const RigidMotion motion = ontoMotion({0.2, 0.1, 0.4}, tilt, 0.5 * tilt, 3.0);
      const NominalForm form = ontoPolynomial(degree, 50.0);
      const auto moved = formOnto(form, kOwnGrid, motion, kOntoGrid);
      ASSERT_TRUE(moved);
      EXPECT_EQ(moved->form.polynomial()->degree, degree);
      const double off = farthestOff(form, moved->form, motion);
      EXPECT_GT(off, 0.0);
      EXPECT_LT(off, 1.2 * moved->off_mm) << degree << ' ' << tilt;
      EXPECT_GT(off, 0.5 * moved->off_mm) << degree << ' ' << tilt;
      // 0.15 mm over 4 mm and a tilt of 0.02.
      EXPECT_LT(moved->off_mm, tilt * 0.01);
    }
}

TEST(FormOnto, ShapesStayThemselves) {
  for (const FormShape kind : {FormShape::kSphere, FormShape::kCylinder, FormShape::kCone})
    for (const double tilt : {0.0, 2.0, 15.0}) {
      ShapeForm shape;
      shape.shape = kind;
      shape.width = kOwnGrid.width;
      shape.height = kOwnGrid.height;
      shape.spacing_x_mm = kOwnGrid.spacingXMm();
      shape.spacing_y_mm = kOwnGrid.spacingYMm();
      shape.height_mm = kOwnGrid.height_unit.mm;
      shape.column = 30.0;
      shape.row = 50.0;
      shape.base = 20e3;
      shape.normal = glm::normalize(glm::dvec3(0.1, -0.05, 1.0));
      const glm::dvec3 across = glm::normalize(glm::cross(shape.normal, glm::dvec3(0.3, 1.0, 0.0)));
      shape.axis = kind == FormShape::kCone ? glm::normalize(across + 0.2 * shape.normal) : across;
      shape.curvature = -1.0 / 50.0;
      ASSERT_TRUE(shape.sound());
      const RigidMotion motion = ontoMotion({0.3, -0.2, 5.0}, tilt, tilt, -25.0);
      const NominalForm form(shape);
      const auto moved = formOnto(form, kOwnGrid, motion, kOntoGrid);
      ASSERT_TRUE(moved);
      EXPECT_EQ(moved->off_mm, 0.0);
      EXPECT_LT(farthestOff(form, moved->form, motion), 1e-11) << static_cast<int>(kind) << ' ' << tilt;
      const ShapeForm& now = *moved->form.shape();
      EXPECT_TRUE(now.sound());
      if (kind != FormShape::kCone) {
        EXPECT_NEAR(now.radius(), 50.0, 1e-9);
      } else {
        EXPECT_NEAR(now.halfAngle(), shape.halfAngle(), 1e-12);
      }
    }
}

TEST(FormOnto, RefusesWhatHasNoPlace) {
  const NominalForm form = ontoPolynomial(3, 50.0);
  // Beside the other field, and upright.
  EXPECT_FALSE(formOnto(form, kOwnGrid, ontoMotion({500.0, 0.0, 0.0}, 1.0, 0.0, 0.0), kOntoGrid));
  EXPECT_FALSE(formOnto(form, kOwnGrid, ontoMotion({}, 90.0, 0.0, 0.0), kOntoGrid));
  ShapeForm shape = someShape(kOwnGrid, FormShape::kSphere, 20e3, 1);
  shape.spacing_x_mm *= 1.5;
  EXPECT_FALSE(formOnto(shape, kOwnGrid, ontoMotion({}, 0.0, 0.0, 0.0), kOntoGrid));
}

}  // namespace
}  // namespace fettle::engine
