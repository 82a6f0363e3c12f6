// Heights of spheres, cylinders and cones over a field, against their plain geometry in long double.
#include "engine/field/shape_form.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "engine/field/nominal_form.h"
#include "tests/support/shape_forms.h"

namespace fettle::engine {
namespace {

using Real = long double;
using Point = glm::vec<3, Real>;

constexpr FormShape kShapes[] = {FormShape::kSphere, FormShape::kCylinder, FormShape::kCone};

Grid gridOf(int width, int height, double spacing_x, double spacing_y, LengthUnit unit = {"mm", 1.0}) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = spacing_x;
  grid.spacing_y = spacing_y;
  grid.height_unit = unit;
  grid.origin_x = grid.origin_y = 5e6;
  return grid;
}

// A point from the foot [mm].
Point fromFoot(const ShapeForm& form, double column, double row, double height) {
  return {(Real{column} - form.column) * form.spacing_x_mm, (Real{row} - form.row) * form.spacing_y_mm,
          (Real{height} - form.base) * form.height_mm};
}

// The plain twin: centre, axis or apex and half angle of the shape, and how far a point is from its surface, whether on the
// nappe of the foot, and the cosine of the inclination there, below 0 where the surface is seen from below.
struct Twin {
  Real distance = 0, cosine = 0, size = 0;  // size: of what the distance is a difference of
  bool nappe = true;
};
Twin twinAt(const ShapeForm& form, const Point& p) {
  const Point n = glm::normalize(Point(form.normal)), a = glm::normalize(Point(form.axis));
  const Real radius = 1 / Real{form.curvature};  // with its sign: the centre is that far along the normal
  const Real outwards = form.curvature > 0.0 ? -1 : 1;
  Twin twin;
  if (form.shape == FormShape::kCone) {
    const Real s = glm::dot(n, a), c = std::sqrt(glm::dot(glm::cross(n, a), glm::cross(n, a)));
    const Point apex = -c / (Real{form.curvature} * s) * ((a - s * n) / c);
    const Point axis = glm::dot(-apex, a) < 0 ? -a : a;
    const Point from = p - apex;
    const Real along = glm::dot(from, axis);
    const Point across = from - along * axis;
    const Real length = glm::length(across);
    twin.distance = outwards * (length * c - std::abs(along) * std::abs(s));
    twin.nappe = along > 0;
    twin.cosine = outwards * (across.z / length * c - axis.z * std::abs(s));
    twin.size = glm::length(from);
    return twin;
  }
  Point from = p - radius * n;
  if (form.shape == FormShape::kCylinder) from -= glm::dot(from, a) * a;
  const Real length = glm::length(from);
  twin.distance = outwards * (length - std::abs(radius));
  twin.cosine = outwards * from.z / length;
  twin.size = std::abs(radius) + glm::length(p);
  return twin;
}

TEST(ShapeForm, HeightsLieOnTheShapeWhereItIsSeenFromAbove) {
  std::int64_t on = 0, beyond = 0;
  for (unsigned seed = 1; seed <= 60; ++seed)
    for (const FormShape shape : kShapes) {
      const Grid grid = seed % 3 == 0   ? gridOf(100, 70, 0.01, 0.04, {"um", 1e-3})
                        : seed % 3 == 1 ? gridOf(64, 1, 1.0, 1.0)
                                        : gridOf(90, 120, 4.0, 1.0, {"m", 1e3});
      const ShapeForm form = someShape(grid, shape, 1.0 / 3.0, seed);
      ASSERT_TRUE(form.sound()) << seed;
      for (int r = 0; r < grid.height; r += 3)
        for (int c = 0; c < grid.width; c += 3) {
          const double z = form.heightAt(c, r);
          ASSERT_TRUE(std::isfinite(z));
          if (form.beyondOutline(c, r)) {
            ++beyond;
            continue;
          }
          const Point p = fromFoot(form, c, r, z);
          const Twin twin = twinAt(form, p);
          // The stated 1e-15 (4.5 roundings) of the distance from the foot, over the cosine where it is small, since the root is
          // that of a difference; the rounding of the height when the base is added; and the twin's own, of its centre.
          const Real eps = std::numeric_limits<double>::epsilon();
          const Real tolerance =
              (1e-15L * glm::length(p) + 16 * std::numeric_limits<Real>::epsilon() * twin.size) /
                  std::max(std::abs(twin.cosine), Real{1e-5L}) +
              eps * (std::abs(z) + form.base) * form.height_mm;
          if (twin.cosine * twin.cosine > 1e-10L) {
            ASSERT_LE(std::abs(twin.distance), tolerance)
                << seed << ' ' << static_cast<int>(shape) << ' ' << c << ' ' << r;
            ASSERT_GT(twin.cosine, 0) << seed << ' ' << static_cast<int>(shape);
            ASSERT_TRUE(twin.nappe) << seed << ' ' << static_cast<int>(shape);
          }
          ++on;
        }
    }
  EXPECT_GT(on, 20000);
  EXPECT_GT(beyond, 5000);
}

// A sample is called beyond the outline only where no height is on the shape, seen from above: tried along its vertical.
TEST(ShapeForm, BeyondTheOutlineThereIsNoShape) {
  for (unsigned seed = 1; seed <= 60; ++seed)
    for (const FormShape shape : kShapes) {
      const Grid grid = gridOf(60, 40, 1.0, 1.0);
      const ShapeForm form = someShape(grid, shape, 0.0, seed);
      const double most = 8.0 * std::hypot(60.0, 40.0);
      for (int r = 0; r < grid.height; r += 7)
        for (int c = 0; c < grid.width; c += 7) {
          if (!form.beyondOutline(c, r)) continue;
          Real before = 0;
          for (int k = 0; k <= 4000; ++k) {
            const Twin twin = twinAt(form, fromFoot(form, c, r, -most + 2.0 * most * k / 4000));
            // From below to above while rising, at a grazing angle hardly to be told apart.
            ASSERT_FALSE(k > 0 && before < 0 && twin.distance > 0 && twin.nappe && twin.cosine > 0.05)
                << seed << ' ' << static_cast<int>(shape) << ' ' << c << ' ' << r << ' ' << k;
            before = twin.distance;
          }
        }
    }
}

TEST(ShapeForm, GoesOnAsThePlaneThroughItsOutline) {
  // A ball in the middle of a plate that is larger than it.
  ShapeForm ball;
  ball.width = ball.height = 101;
  ball.column = ball.row = 50.0;
  ball.base = 20.0;
  ball.curvature = -1.0 / 20.0;
  for (int c = 0; c <= 100; ++c) {
    EXPECT_EQ(ball.beyondOutline(c, 50), std::abs(c - 50) > 20) << c;
    EXPECT_DOUBLE_EQ(ball.heightAt(c, 50), std::sqrt(std::max(0.0, 400.0 - (c - 50.0) * (c - 50.0)))) << c;
  }
  // A rod, tilted along the rows; and no step anywhere: along a line across the outline two heights differ by no more than the root
  // of how far they are apart says, of any shape.
  for (unsigned seed = 1; seed <= 40; ++seed)
    for (const FormShape shape : kShapes) {
      const Grid grid = gridOf(80, 50, 1.0, 1.0);
      const ShapeForm form = someShape(grid, shape, 0.0, seed);
      const double side = 1e-9;
      for (int r = 0; r < 50; ++r) {
        bool before = form.beyondOutline(0, r);
        for (int c = 1; c < 80; ++c) {
          const bool now = form.beyondOutline(c, r);
          if (now == before) continue;
          double low = c - 1.0, high = c;
          while (high - low > side) {
            const double middle = 0.5 * (low + high);
            (form.beyondOutline(middle, r) == before ? low : high) = middle;
          }
          before = now;
          // Near the apex of a cone the outline is bent as sharply as one likes.
          const double away = std::abs(form.heightAt(low, r) - form.heightAt(high, r));
          EXPECT_LT(away, 1e-2 * (1.0 + std::abs(form.heightAt(low, r))))
              << seed << ' ' << static_cast<int>(shape);
        }
      }
    }
}

TEST(ShapeForm, OfALargeRadiusKeepsItsDigits) {
  for (const double radius : {1e3, 1e6, 1e9}) {
    ShapeForm form;
    form.width = form.height = 100;
    form.spacing_x_mm = form.spacing_y_mm = 0.1;
    form.column = form.row = 50.0;
    form.curvature = -1.0 / radius;
    ASSERT_TRUE(form.sound());
    for (const int c : {0, 1, 30, 49, 50, 99}) {
      const Real d = (c - 50) * Real{0.1L},
                 exact = -d * d / (radius + std::sqrt(Real{radius} * radius - d * d));
      EXPECT_NEAR(form.heightAt(c, 50), static_cast<double>(exact),
                  1e-15 * std::abs(static_cast<double>(exact)) * 8)
          << radius;
    }
  }
}

TEST(ShapeForm, HasTheSameBitsHoweverItIsRead) {
  std::mt19937 random(5);
  for (unsigned seed = 1; seed <= 30; ++seed)
    for (const FormShape shape : kShapes) {
      const Grid grid = gridOf(190, 130, 0.7, 1.3);
      const ShapeForm form = someShape(grid, shape, seed * 1e5, seed);
      const NominalForm upside_down = NominalForm(form).inverted();
      EXPECT_EQ(upside_down.inverted(), NominalForm(form));
      const SampleRect rect{static_cast<std::int32_t>(random() % 100),
                            static_cast<std::int32_t>(random() % 60), 65, 61};
      std::vector<double> heights(70 * 61), inverted(70 * 61);
      form.readHeights(rect, heights.data(), 70);
      upside_down.readHeights(rect, inverted.data(), 70);
      for (int r = 0; r < rect.rows; ++r)
        for (int c = 0; c < rect.columns; ++c) {
          const auto k = static_cast<std::size_t>(70 * r + c);
          ASSERT_EQ(heights[k], form.heightAt(rect.column + c, rect.row + r));
          ASSERT_EQ(inverted[k], -heights[k]);
        }
    }
}

// Additions, multiplications, divisions and roots alone: these bits are those of every machine.
TEST(ShapeForm, HasTheBitsThatWereWrittenDown) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const FormShape shape : kShapes) {
    ShapeForm form;
    form.shape = shape;
    form.width = 40;
    form.height = 30;
    form.column = 11.25;
    form.row = 7.5;
    form.base = 1.0 / 3.0;
    form.normal = {0.48, 0.36, 0.8};
    form.axis = shape == FormShape::kCone ? glm::dvec3(0.8, 0.0, -0.6) : glm::dvec3(0.6, -0.8, 0.0);
    form.curvature = -0.03;
    form.spacing_x_mm = 0.7;
    form.spacing_y_mm = 1.3;
    ASSERT_TRUE(form.sound());
    for (int r = 0; r < 30; ++r)
      for (int c = 0; c < 40; ++c)
        hash = (hash ^ std::bit_cast<std::uint64_t>(form.heightAt(c, r))) * 0x100000001b3;
  }
  EXPECT_EQ(hash, 2305782200573325518U);
}

TEST(ShapeForm, SaysItsFigures) {
  const ShapeForm sphere = someShape(gridOf(100, 100, 1.0, 1.0), FormShape::kSphere, 0.0, 3);
  EXPECT_DOUBLE_EQ(sphere.radius(), 1.0 / std::abs(sphere.curvature));
  ShapeForm cone;
  cone.shape = FormShape::kCone;
  cone.axis = {std::sin(0.3), 0.0,
               std::cos(0.3)};  // a normal 0.3 from the axis: a flank of 90 degrees less that
  EXPECT_NEAR(cone.halfAngle(), std::acos(0.0) - 0.3, 1e-15);
}

}  // namespace
}  // namespace fettle::engine
