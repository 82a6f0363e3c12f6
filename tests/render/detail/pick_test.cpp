// Picking against a brute force over all cells, and against what contact feels.
#include "render/detail/pick.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/contact/collision.h"
#include "tests/render/support/fields.h"

namespace fettle::render {
namespace {

double bumpy(int c, int r) {
  return 2.0 * std::sin(c * 0.3) * std::cos(r * 0.21) + 0.4 * ((c * 7 + r * 13) % 11) + (c > 60 ? 9.0 : 0.0);
}

// Smallest t at which the line meets any whole cell, by 4000 steps within each cell's part and bisection.
double bruteForce(const engine::FieldReader& reader, const glm::dvec3& from, const glm::dvec3& dir) {
  const double sx = reader.grid().spacingXMm(), sy = reader.grid().spacingYMm();
  double best = HUGE_VAL;
  for (int r = 0; r + 1 < reader.height(); ++r)
    for (int c = 0; c + 1 < reader.width(); ++c) {
      double enter = 0.0, leave = HUGE_VAL;
      const auto cut = [&](double at, double along, double low, double high) {
        if (along == 0.0) {
          if (at < low || at > high) leave = -1.0;
          return;
        }
        enter = std::max(enter, std::min((low - at) / along, (high - at) / along));
        leave = std::min(leave, std::max((low - at) / along, (high - at) / along));
      };
      cut(from.x, dir.x, c * sx, (c + 1) * sx);
      cut(from.y, dir.y, r * sy, (r + 1) * sy);
      if (!(enter <= leave) || enter > best) continue;
      // A line straight down stays in its cell.
      leave = std::min(leave, enter + 200.0);
      const double z00 = reader.heightAt(c, r), z11 = reader.heightAt(c + 1, r + 1),
                   z10 = reader.heightAt(c + 1, r), z01 = reader.heightAt(c, r + 1);
      if (std::isnan(z00 + z11 + z10 + z01)) continue;
      const auto above = [&](double t) {
        const double u = std::clamp((from.x + t * dir.x) / sx - c, 0.0, 1.0);
        const double v = std::clamp((from.y + t * dir.y) / sy - r, 0.0, 1.0);
        return from.z + t * dir.z - ((1 - v) * ((1 - u) * z00 + u * z10) + v * ((1 - u) * z01 + u * z11));
      };
      constexpr int kSteps = 400;
      double t0 = enter, a0 = above(t0);
      for (int i = 1; i <= kSteps; ++i) {
        const double t1 = enter + (leave - enter) * i / kSteps, a1 = above(t1);
        if (std::signbit(a0) != std::signbit(a1)) {
          double low = t0, high = t1;
          for (int k = 0; k < 60; ++k) {
            const double mid = 0.5 * (low + high);
            (std::signbit(above(mid)) == std::signbit(a0) ? low : high) = mid;
          }
          best = std::min(best, high);
          break;
        }
        t0 = t1;
        a0 = a1;
      }
    }
  return best;
}

TEST(Pick, TheFirstMeetingIsTheOneBruteForceFinds) {
  const engine::Version field = fieldOf(gridOf(97, 75, 0.5, 0.8), [](int c, int r) {
    return (c > 20 && c < 33 && r > 40 && r < 47) || (c * 5 + r * 3) % 173 == 0 ? kNan : bumpy(c, r);
  });
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int met = 0;
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 target(48 * unit(random), 59 * unit(random), 12 * unit(random));
    glm::dvec3 dir(unit(random) - 0.5, unit(random) - 0.5, -0.02 - unit(random));
    if (i % 7 == 0) dir = {0, 0, -1};
    if (i % 11 == 0) dir.x = 0.0;
    if (i % 13 == 0) dir.z = 0.3;
    dir = glm::normalize(dir);
    const glm::dvec3 from = target - (i % 5 == 0 ? 3.0 : 80.0) * dir;
    const double expected = bruteForce(field.reader(), from, dir);
    const auto hit = meetSurface(field.reader(), from, dir);
    ASSERT_EQ(hit.has_value(), expected < HUGE_VAL) << i;
    if (!hit) continue;
    ++met;
    // 1e-9 mm: bisection stops at 1e-15 of a cell's part; a line that grazes the surface turns rounding of
    // 1e-13 mm in height into its square root along the line at worst.
    ASSERT_NEAR(hit->along, expected, 2e-6) << i;
    ASSERT_NEAR(hit->position_mm.z, *surfaceHeight(field.reader(), hit->position_mm.x, hit->position_mm.y),
                1e-6)
        << i;
  }
  EXPECT_GT(met, 150);
}

TEST(Pick, APickedPointIsWhereContactBegins) {
  // What the haptic ray touches first on its way from above is the cell that is picked, at the same place.
  const engine::Version field = fieldOf(gridOf(300, 200), bumpy);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 target(40 + 200 * unit(random), 40 + 100 * unit(random), 5.0);
    const glm::dvec3 dir = glm::normalize(glm::dvec3(unit(random) - 0.5, unit(random) - 0.5, -1.0));
    const glm::dvec3 from = target - 30.0 * dir, to = target + 30.0 * dir;
    const auto hit = meetSurface(field.reader(), from, dir);
    ASSERT_TRUE(hit);
    haptic::Surface surface(field.reader());
    haptic::RayWalk walk(surface, from, to);
    haptic::RayCell cell;
    bool found = false;
    while (!found && walk.next(cell)) {
      haptic::Patch patch;
      found = surface.patch(cell.cell, patch) && haptic::entersPatch(patch, from, to, cell.enter, cell.leave);
    }
    ASSERT_TRUE(found);
    const double t = hit->along / 60.0;
    ASSERT_GE(t, cell.enter - 1e-9);
    ASSERT_LE(t, cell.leave + 1e-9);
  }
}

TEST(Pick, NothingIsMetInHolesBesideTheFieldAndOnFieldsWithoutCells) {
  const auto down = [](const engine::Version& v, double x, double y) {
    return meetSurface(v.reader(), {x, y, 100.0}, {0.0, 0.0, -1.0});
  };
  const engine::Version field =
      fieldOf(gridOf(40, 40), [](int c, int r) { return c == 20 && r == 20 ? kNan : 1.0; });
  EXPECT_TRUE(down(field, 10.5, 10.5));
  EXPECT_FALSE(down(field, 20.2, 19.7));
  EXPECT_FALSE(down(field, -0.1, 3));
  EXPECT_FALSE(down(field, 39.1, 3));
  EXPECT_FALSE(meetSurface(field.reader(), {5, 5, 100}, {0, 0, 1}));
  EXPECT_FALSE(down(fieldOf(gridOf(1, 30), [](int, int) { return 1; }), 0, 3));
  EXPECT_FALSE(down(fieldOf(gridOf(30, 30), [](int, int) { return kNan; }), 3, 3));
  const auto spike = fieldOf(gridOf(600, 600), [](int c, int r) { return c == 300 && r == 300 ? 1e6 : 0.0; });
  const auto hit = meetSurface(spike.reader(), {0.0, 300.2, 5e5}, {1.0, 0.0, 0.0});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->column, 299);
  EXPECT_NEAR(hit->position_mm.x, 299.0 + 5e5 / 8e5, 1e-6);  // the cell's height at v = 0.2 is 8e5 u
}

}  // namespace
}  // namespace fettle::render
