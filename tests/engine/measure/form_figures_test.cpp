// What forms are in figures: points of their surface lie on the shape that is stated.
#include "engine/measure/form_figures.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "tests/support/shape_forms.h"

namespace fettle::engine {
namespace {

Grid figuresGrid(int width, int height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = 0.1;
  grid.spacing_y = 0.15;
  grid.height_unit = {"um", 1e-3};
  return grid;
}

TEST(FormFigures, ThePointsOfAFormLieOnItsShape) {
  const Grid grid = figuresGrid(60, 50);
  int points = 0;
  for (const FormShape kind : {FormShape::kSphere, FormShape::kCylinder, FormShape::kCone})
    for (unsigned seed = 1; seed <= 200; ++seed) {
      const ShapeForm form = someShape(grid, kind, 300.0, seed);
      const Shape shape = shapeOfForm(form);
      EXPECT_EQ(shape.hollow, form.curvature > 0.0);
      EXPECT_NEAR(glm::length(shape.direction), 1.0, 1e-12);
      if (kind != FormShape::kCone) {
        EXPECT_EQ(shape.radius, form.radius());
      }
      for (int r = 0; r < grid.height; r += 7)
        for (int c = 0; c < grid.width; c += 7) {
          if (form.beyondOutline(c, r)) continue;
          const glm::dvec3 p(c * grid.spacingXMm(), r * grid.spacingYMm(),
                             grid.height_unit.mm * form.heightAt(c, r));
          // Apex and centre may lie 1e5 mm away.
          ASSERT_NEAR(distanceFrom(shape, p), 0.0, 1e-12 * (1.0 + glm::length(shape.point - p)))
              << static_cast<int>(kind) << ' ' << seed;
          ++points;
        }
    }
  EXPECT_GT(points, 5000);
}

TEST(FormFigures, APlaneIsTiltedAndAMeanIsNot) {
  const Grid grid = figuresGrid(101, 51);
  // 2 um over each half of 5 mm along x, -1 um over each of 3.75 mm along y.
  const NominalForm plane = PolynomialForm{1, 101, 51, 7.0, {0.0, -1.0, 2.0}};
  const auto tilt = tiltOf(plane, grid);
  ASSERT_TRUE(tilt);
  EXPECT_NEAR(tilt->x_deg, std::atan(2e-3 / 5.0) * 180.0 / std::numbers::pi, 1e-15);
  EXPECT_NEAR(tilt->y_deg, std::atan(-1e-3 / 3.75) * 180.0 / std::numbers::pi, 1e-15);
  EXPECT_TRUE(std::isnan(tilt->x_error_deg));
  EXPECT_FALSE(tiltOf(NominalForm(), grid));
}

}  // namespace
}  // namespace fettle::engine
