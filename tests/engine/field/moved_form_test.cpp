// Forms at other places, against the old form read there.
#include "engine/field/moved_form.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "engine/field/grid.h"
#include "tests/support/shape_forms.h"

namespace fettle::engine {
namespace {

constexpr FormShape kMovedShapes[] = {FormShape::kSphere, FormShape::kCylinder, FormShape::kCone};

class Chance {
 public:
  explicit Chance(unsigned seed) : random_(seed) {}
  double real(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) * 0x1p-32;
  }
  std::int32_t whole(std::int32_t low, std::int32_t high) {
    return low + static_cast<std::int32_t>(random_() % static_cast<unsigned>(high - low + 1));
  }

 private:
  std::mt19937 random_;
};

PolynomialForm aPolynomial(int degree, std::int32_t width, std::int32_t height, Chance& random) {
  PolynomialForm form{degree, width, height, random.real(-1e3, 1e3), {}};
  for (int k = 0; k < PolynomialForm::terms(degree); ++k) form.coefficients.push_back(random.real(-1.0, 1.0));
  return form;
}

Grid movedGrid(std::int32_t width, std::int32_t height, double spacing_x, double spacing_y) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = spacing_x;
  grid.spacing_y = spacing_y;
  return grid;
}

// The largest difference at the samples of the new field, over a bound for each.
double worstMoved(const NominalForm& moved, const NominalForm& form, const PlaceMap& places, double bound) {
  double most = 0.0;
  for (std::int32_t r = 0; r < moved.height(); ++r)
    for (std::int32_t c = 0; c < moved.width(); ++c) {
      const glm::dvec2 old = places.at(c, r);
      most = std::max(most, std::abs(moved.heightAt(c, r) - form.heightAt(old.x, old.y)) / bound);
    }
  return most;
}

// Within the old field |T| <= 1, so that each of 21 terms of size 1 is off by some roundings; the base by one of 1e3.
TEST(MovedForm, APolynomialIsTheSameOneAtPlacesWithinItsField) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    Chance random(seed);
    const int degree = static_cast<int>(seed % 6);
    const std::int32_t width = random.whole(1, 90), height = random.whole(1, 70);
    const NominalForm form = aPolynomial(degree, width, height, random);
    // A sheared grid whose corners all lie within.
    PlaceMap places;
    const std::int32_t columns = random.whole(1, 40), rows = random.whole(1, 40);
    places.first = {random.real(0.3, 0.6) * (width - 1), random.real(0.3, 0.6) * (height - 1)};
    places.per_column = {random.real(-0.2, 0.2) * (width - 1) / columns,
                         random.real(-0.2, 0.2) * (height - 1) / columns};
    places.per_row = {random.real(-0.1, 0.1) * (width - 1) / rows,
                      random.real(-0.1, 0.1) * (height - 1) / rows};
    const auto moved = movedForm(form, places, columns, rows);
    ASSERT_TRUE(moved);
    EXPECT_EQ(moved->width(), columns);
    EXPECT_EQ(moved->height(), rows);
    EXPECT_EQ(moved->polynomial()->degree, degree);
    EXPECT_LT(worstMoved(*moved, form, places, 1e-12), 1.0) << seed;
  }
}

TEST(MovedForm, AMirroredPolynomialHasItsCoefficients) {
  Chance random(7);
  const PolynomialForm form = aPolynomial(5, 37, 20, random);
  // Left and right change places.
  const auto mirrored = movedForm(form, {.first = {36.0, 0.0}, .per_column = {-1.0, 0.0}}, 37, 20);
  ASSERT_TRUE(mirrored);
  std::size_t k = 0;
  for (int i = 0; i <= 5; ++i)
    for (int j = 0; i + j <= 5; ++j, ++k)
      EXPECT_EQ(mirrored->polynomial()->coefficients[k], (i % 2 == 0 ? 1.0 : -1.0) * form.coefficients[k]);
  const auto back = movedForm(*mirrored, {.first = {36.0, 0.0}, .per_column = {-1.0, 0.0}}, 37, 20);
  EXPECT_EQ(*back, NominalForm(form));
}

// Crops, mirrors and turns by any angle, with another spacing; far from the foot, over the outline and beyond.
TEST(MovedForm, AShapeIsTheSameOneSeenFromTheSameSide) {
  int moved_feet = 0, left_out = 0, trials = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    for (const FormShape kind : kMovedShapes) {
      Chance random(seed);
      const double sx = random.real(0.05, 0.2), sy = random.real(0.05, 0.2);
      const ShapeForm shape = someShape(movedGrid(80, 60, sx, sy), kind, random.real(-100.0, 100.0), seed);
      ASSERT_TRUE(shape.sound());
      const double angle = random.real(-std::numbers::pi, std::numbers::pi),
                   side = seed % 2 == 0 ? -1.0 : 1.0;
      const double to_x = random.real(0.05, 0.4), to_y = random.real(0.05, 0.4);
      PlaceMap places;
      places.first = {random.real(20.0, 60.0), random.real(15.0, 45.0)};
      places.per_column = {side * std::cos(angle) * to_x / sx, side * std::sin(angle) * to_x / sy};
      places.per_row = {-std::sin(angle) * to_y / sx, std::cos(angle) * to_y / sy};
      const NominalForm form(shape);
      const auto moved = movedForm(form, places, random.whole(8, 40), random.whole(8, 40));
      ++trials;
      if (!moved) {
        ++left_out;
        continue;
      }
      ASSERT_TRUE(moved->shape()->sound());
      const double foot_x = moved->shape()->column, foot_y = moved->shape()->row;
      const glm::dvec2 same = places.newPlace({shape.column, shape.row});
      moved_feet += std::abs(same.x - foot_x) + std::abs(same.y - foot_y) > 1e-6 ? 1 : 0;
      // Over an inclination of a cosine of a hundredth, and at the outline, where a root has half the digits: [mm].
      EXPECT_LT(worstMoved(*moved, form, places, 1e-6), 1.0) << seed << ' ' << static_cast<int>(kind);
    }
  }
  EXPECT_GT(moved_feet, 200);
  EXPECT_LT(left_out, trials / 20);
}

// On a gentle part of a shape nothing but rounding is left.
TEST(MovedForm, AGentleShapeMovesToRounding) {
  for (const FormShape kind : kMovedShapes)
    for (const double radius : {40.0, 1e3, 1e9}) {
      ShapeForm shape;
      shape.shape = kind;
      shape.width = 200;
      shape.height = 160;
      shape.spacing_x_mm = shape.spacing_y_mm = 0.1;
      shape.column = 20.0;
      shape.row = 30.0;
      shape.base = 12.0;
      shape.curvature = -1.0 / radius;
      if (kind == FormShape::kCone) shape.axis = glm::normalize(glm::dvec3(1.0, 0.2, 0.15));
      const NominalForm form(shape);
      const PlaceMap corner{.first = {120.0, 100.0}};
      const auto moved = movedForm(form, corner, 80, 60);
      ASSERT_TRUE(moved);
      EXPECT_NE(moved->shape()->column, -100.0);  // its foot lies over the corner
      EXPECT_LT(worstMoved(*moved, form, corner, 1e-13), 1.0) << radius;
      if (kind != FormShape::kCone) {
        EXPECT_NEAR(moved->shape()->radius() / radius, 1.0, 1e-12);
      }
    }
}

TEST(MovedForm, AStretchedShapeIsNone) {
  const ShapeForm sphere = someShape(movedGrid(50, 40, 0.1, 0.1), FormShape::kSphere, 0.0, 3);
  EXPECT_FALSE(movedForm(sphere, {.per_column = {1.0, 0.3}}, 50, 40));
  EXPECT_FALSE(movedForm(sphere, {.per_column = {0.0, 0.0}}, 50, 40));
  EXPECT_TRUE(movedForm(sphere, {.per_column = {2.0, 0.0}}, 25, 40));  // another spacing is no stretch
}

}  // namespace
}  // namespace fettle::engine
