// Where an alignment begins: the places of the greatest correlation.
#include "engine/measure/align_search.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

using Relief = std::function<double(double x, double y)>;

// On cells of 0.25 mm, the part turned by `degrees` about (`x`, `y`) and shifted, with heights in a unit of its own.
HeightMap scanned(std::int32_t width, std::int32_t height, const Relief& relief,
                  const RigidMotion& motion = {}, double unit = 1.0) {
  HeightMap map;
  map.width = width;
  map.height = height;
  map.spacing_x = map.spacing_y = 0.25;
  for (std::int32_t r = 0; r < height; ++r)
    for (std::int32_t c = 0; c < width; ++c) {
      const glm::dvec3 p = motion.movedBack({0.25 * c, 0.25 * r, 0.0});
      map.z.push_back(unit * relief(p.x, p.y));
    }
  return map;
}

RigidMotion turned(double degrees, const glm::dvec3& shift, const glm::dvec3& centre) {
  return RigidMotion{glm::dmat3(1.0), glm::dvec3(0.0), centre}.then(
      shift, glm::dvec3(0.0, 0.0, degrees * std::numbers::pi / 180.0));
}

// How far the nearest of the motions that are likely is from the true one, at two places [mm].
double nearest(const std::vector<RigidMotion>& motions, const RigidMotion& truth,
               const std::vector<glm::dvec3>& places) {
  double least = 1e9;
  for (const RigidMotion& motion : motions) {
    double most = 0.0;
    for (const glm::dvec3& p : places) {
      const glm::dvec3 d = motion.moved(p) - truth.moved(p);
      most = std::max(most, std::hypot(d.x, d.y));
    }
    least = std::min(least, most);
  }
  return least;
}

double hillsAt(double x, double y) {
  return 0.4 * std::sin(0.9 * x + 0.3) * std::cos(0.7 * y) + 0.25 * std::sin(1.7 * x - 1.3 * y + 1.0) +
         0.15 * std::cos(2.9 * y + 0.04 * x * x);
}

TEST(AlignSearch, FindsTheSameMotionsInAnyUnitOfHeight) {
  const glm::dvec3 centre(10.0, 8.0, 0.0);
  const RigidMotion truth = turned(4.0, {1.5, -2.0, 0.0}, centre);
  JobControl job;
  std::vector<RigidMotion> in_mm;
  for (const double unit : {1.0, 1e-3, 1e4}) {
    const std::vector<RigidMotion> motions = likelyMotions(
        scanned(80, 64, hillsAt, truth, unit), scanned(80, 64, hillsAt, {}, unit), 6.0, centre, job);
    ASSERT_FALSE(motions.empty());
    // The likeliest is the true one, to the 0.25 mm of a cell and half of a step of 3 degrees at 10 mm.
    EXPECT_LT(nearest({motions.front()}, truth, {centre, centre + glm::dvec3(10.0, 0.0, 0.0)}), 0.6) << unit;
    if (unit == 1.0) in_mm = motions;
    ASSERT_EQ(motions.size(), in_mm.size()) << unit;
    for (std::size_t i = 0; i < motions.size(); ++i) {
      EXPECT_NEAR(motions[i].shift.x, in_mm[i].shift.x, 1e-9) << unit << ' ' << i;
      EXPECT_NEAR(motions[i].shift.y, in_mm[i].shift.y, 1e-9) << unit << ' ' << i;
    }
  }
}

// A long bar whose ends alone have a shape: turned, they lie far above and below its middle.
TEST(AlignSearch, TurnsALongPartWithItsEnds) {
  const auto bar = [](double x, double y) {
    const auto bump = [&](double at_x, double at_y, double size) {
      return size * std::exp(-0.5 * (std::pow(x - at_x, 2) + std::pow(y - at_y, 2)) / 0.36);
    };
    return bump(3.0, 2.0, 1.0) + bump(5.0, 4.5, 0.7) + bump(35.0, 4.0, 0.8) + bump(37.5, 1.5, 1.2);
  };
  const glm::dvec3 centre(20.0, 20.0, 0.0), middle(20.0, 3.0, 0.0);
  // 40 mm long and 6 mm wide, in a scan of 40 mm x 40 mm turned by 30 degrees.
  const RigidMotion truth = turned(30.0, {0.0, 17.0, 0.0}, middle);
  JobControl job;
  const std::vector<RigidMotion> motions =
      likelyMotions(scanned(161, 161, bar, truth), scanned(161, 25, bar), 30.0, centre, job);
  ASSERT_FALSE(motions.empty());
  EXPECT_LT(nearest(motions, truth, {{3.0, 2.0, 0.0}, {37.5, 1.5, 0.0}}), 1.0);
}

}  // namespace
}  // namespace fettle::engine
