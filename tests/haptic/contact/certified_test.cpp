#include "haptic/contact/certified.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/contact/descent.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

using tests::bruteDistance2;
using tests::fieldOf;
using tests::randomField;
using tests::uniform;

// Distances come from differences of coordinates as large as `size`: an error of a few roundings of that in
// the distance, and Newton leaves the point within 1e-7 of its parameters' minimum, where the distance is
// flat.
double tolerance(double distance, double size) {
  return 1e-11 * distance + 64 * 2.3e-16 * size;
}

// Every cell within the radius, in long double.
long double bruteCertified(Surface& surface, const glm::dvec3& e, double radius) {
  long double best = HUGE_VALL;
  for (int r = 0; r < surface.cellRows(); ++r)
    for (int c = 0; c < surface.cellColumns(); ++c) {
      Patch patch;
      if (!surface.patch({c, r}, patch)) continue;
      const double dx = std::max({c * patch.sx - e.x, e.x - (c + 1) * patch.sx, 0.0});
      const double dy = std::max({r * patch.sy - e.y, e.y - (r + 1) * patch.sy, 0.0});
      if (dx * dx + dy * dy > radius * radius) continue;
      best = std::min(best, bruteDistance2(patch, e));
    }
  return best;
}

TEST(Certified, ClosestPointOfOnePatchEqualsBruteForceOnEveryKindOfPatch) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 6000; ++i) {
    const double sx = i % 3 == 0 ? 0.1 : 1.0;
    const double sy = i % 5 == 0 ? 3.0 : 1.0;
    const engine::Version field = randomField(random, 2, 2, i, sx, sy);
    Surface surface(field.reader());
    Patch patch;
    ASSERT_TRUE(surface.patch({0, 0}, patch));
    const double reach = i % 7 == 0 ? 30.0 : 2.0;
    const glm::dvec3 e{uniform(random, -reach, reach), uniform(random, -reach, reach),
                       uniform(random, -reach, reach) + (i % 2 == 0 ? patch.lowest() : 0.0)};
    const PatchPoint found = closestOnWholePatch(patch, e);
    const double brute = static_cast<double>(std::sqrt(bruteDistance2(patch, e)));
    ASSERT_NEAR(std::sqrt(found.distance2_mm2), brute,
                tolerance(brute, std::abs(patch.highest()) + std::abs(patch.lowest()) + reach))
        << "case " << i;
  }
}

TEST(Certified, EqualsBruteForceOverAllCellsOnSmallRandomFields) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 240; ++i) {
    const double sx = i % 4 == 0 ? 0.25 : 1.0;
    const engine::Version field = randomField(random, 9, 7, i, sx, 1.0, i % 3 == 0 ? 0.08 : 0.0);
    Surface surface(field.reader());
    for (int k = 0; k < 6; ++k) {
      const glm::dvec3 e{uniform(random, -1.0, 8.0 * sx + 1.0), uniform(random, -1.0, 7.0),
                         uniform(random, -6.0, 6.0)};
      const double radius = uniform(random, 0.2, 12.0);
      const long double brute2 = bruteCertified(surface, e, radius);
      SurfacePoint point;
      const bool found = certifiedClosest(surface, e, radius, point);
      ASSERT_EQ(found, std::isfinite(brute2)) << i;
      if (!found) continue;
      const double brute = static_cast<double>(std::sqrt(brute2));
      ASSERT_NEAR(std::sqrt(point.distance2_mm2), brute, tolerance(brute, i % 6 == 4 ? 1e6 : 50.0))
          << "field " << i;
      // And the point is where it says it is.
      const double apart = glm::length(point.position_mm - e);
      ASSERT_NEAR(apart, brute, tolerance(brute, i % 6 == 4 ? 1e6 : 50.0));
    }
  }
}

// From windows of few cells, without the pyramid, to those with it, also with many more columns than rows and the reverse.
TEST(Certified, EqualsBruteForceInWindowsOfEverySize) {
  std::mt19937_64 random(19);
  for (const auto& [sx, sy] : {std::pair{1.0, 1.0}, {0.25, 1.0}, {1.0, 0.25}}) {
    const engine::Version field = randomField(random, 60, 60, 1, sx, sy);
    Surface surface(field.reader());
    for (int step = 0; step < 62; ++step) {
      const double radius = 1.0 + 0.13 * step;
      const glm::dvec3 e{uniform(random, 20, 40) * sx, uniform(random, 20, 40) * sy,
                         uniform(random, -6.0, 6.0)};
      const long double brute2 = bruteCertified(surface, e, radius);
      SurfacePoint point;
      ASSERT_EQ(certifiedClosest(surface, e, radius, point), std::isfinite(brute2)) << radius;
      if (!std::isfinite(brute2)) continue;
      const double brute = static_cast<double>(std::sqrt(brute2));
      ASSERT_NEAR(std::sqrt(point.distance2_mm2), brute, tolerance(brute, 50.0))
          << sx << ' ' << sy << ' ' << radius;
    }
  }
}

TEST(Certified, PyramidPruningChangesNothingOnAFieldOfSeveralTiles) {
  std::mt19937_64 random(5);
  const engine::Version field = randomField(random, 150, 140, 1, 1.0, 1.0, 0.02);
  Surface surface(field.reader());
  for (int k = 0; k < 25; ++k) {
    const glm::dvec3 e{uniform(random, 0, 149), uniform(random, 0, 139), uniform(random, -3.0, 4.0)};
    const double radius = uniform(random, 8.0, 20.0);
    SurfacePoint point;
    ASSERT_TRUE(certifiedClosest(surface, e, radius, point));
    const double brute = static_cast<double>(std::sqrt(bruteCertified(surface, e, radius)));
    ASSERT_NEAR(std::sqrt(point.distance2_mm2), brute, tolerance(brute, 300.0));
  }
}

TEST(Certified, IsNeverFartherThanTheLocalSearchWithinTheRadius) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 200; ++i) {
    const engine::Version field = randomField(random, 30, 30, i, 1.0, 1.0);
    Surface surface(field.reader());
    const glm::dvec3 e{uniform(random, 8, 21), uniform(random, 8, 21), uniform(random, -3.0, 3.0)};
    CellIndex own;
    ASSERT_TRUE(surface.cellUnder(e, own));
    const SearchResult local = searchDownhill(surface, e, own, 0.5, 0.5);
    SurfacePoint point;
    ASSERT_TRUE(certifiedClosest(surface, e, 8.0, point));
    if (glm::length(local.point.position_mm - e) < 8.0) {
      EXPECT_LE(point.distance2_mm2, local.point.distance2_mm2);
    }
  }
}

TEST(Certified, FindsNothingOnAFieldOfOneRowOrOfHoles) {
  const engine::Version one_row = fieldOf(9, 1, [](int, int) { return 1.0; });
  const engine::Version holes = fieldOf(9, 9, [](int, int) { return NAN; });
  for (const engine::Version* field : {&one_row, &holes}) {
    Surface surface(field->reader());
    SurfacePoint point;
    EXPECT_FALSE(certifiedClosest(surface, {4.0, 0.0, 0.0}, 5.0, point));
  }
}

}  // namespace
}  // namespace fettle::haptic
