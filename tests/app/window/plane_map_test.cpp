#include "app/window/plane_map.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

TEST(PlaneMap, gives_back_what_a_perspective_picture_shows) {
  // A camera over the plane: pixel = (fx x / w, fy y / w) with w falling along y.
  const auto picture = [](const glm::dvec2& p) {
    const double w = 3.0 - 0.02 * p.y;
    return glm::dvec2(400.0 + 900.0 * (p.x - 20.0) / w / 20.0, 300.0 - 700.0 * p.y / w / 20.0);
  };
  std::array<PlaneMap::Pair, 4> pairs;
  const std::array<glm::dvec2, 4> places{glm::dvec2{10, 10}, {30, 10}, {10, 30}, {30, 30}};
  for (std::size_t i = 0; i < 4; ++i) pairs[i] = {picture(places[i]), places[i]};
  const auto map_back = PlaneMap::through(pairs);
  ASSERT_TRUE(map_back);
  for (double x = -40.0; x <= 80.0; x += 7.3)
    for (double y = -60.0; y <= 120.0; y += 9.1) {
      const auto back = map_back->fieldAt(picture({x, y}));
      ASSERT_TRUE(back);
      // Two inversions of 3 x 3 matrices whose condition is below 1e6: 1e-10 of the extent.
      EXPECT_NEAR(back->x, x, 1e-6);
      EXPECT_NEAR(back->y, y, 1e-6);
    }
  // The horizon is where w is zero, at y = 150: above it lies nothing.
  const double horizon = 300.0 + 700.0 / 20.0 / 0.02;
  EXPECT_FALSE(map_back->fieldAt({400.0, horizon + 50.0}));
}

TEST(PlaneMap, points_on_a_line_say_nothing) {
  std::array<PlaneMap::Pair, 4> pairs;
  for (std::size_t i = 0; i < 4; ++i)
    pairs[i] = {glm::dvec2(static_cast<double>(i), 2.0 * static_cast<double>(i)),
                glm::dvec2(static_cast<double>(i * i), static_cast<double>(i))};
  EXPECT_FALSE(PlaneMap::through(pairs));
  pairs[0].pixel.x = std::nan("");
  EXPECT_FALSE(PlaneMap::through(pairs));
}

}  // namespace
}  // namespace fettle::app
