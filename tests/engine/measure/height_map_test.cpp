// Smooth height maps.
#include "engine/measure/height_map.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

HeightMap mapOf(std::int32_t width, std::int32_t height, double spacing_x, double spacing_y,
                const std::function<double(int, int)>& z) {
  HeightMap map;
  map.width = width;
  map.height = height;
  map.spacing_x = spacing_x;
  map.spacing_y = spacing_y;
  for (std::int32_t r = 0; r < height; ++r)
    for (std::int32_t c = 0; c < width; ++c) map.z.push_back(z(c, r));
  return map;
}

// Noise with holes, of whatever place.
double holedNoise(int c, int r) {
  if ((c * 5 + r * 3) % 11 == 0) return std::numeric_limits<double>::quiet_NaN();
  std::mt19937 random(static_cast<unsigned>(1000 * r + c));
  return std::normal_distribution<double>()(random);
}

// Places that one map has as the other, but for roundings of sums over a window.
void expectAlike(const SmoothMap& one, const SmoothMap& other,
                 const std::function<std::pair<int, int>(int, int)>& place, bool turned, double way_y) {
  const HeightMap& map = one.value;
  int there = 0;
  for (int r = 0; r < map.height; ++r)
    for (int c = 0; c < map.width; ++c) {
      const auto [oc, orow] = place(c, r);
      const std::size_t a = map.index(c, r), b = other.value.index(oc, orow);
      ASSERT_EQ(std::isnan(map.z[a]), std::isnan(other.value.z[b])) << c << ' ' << r;
      if (std::isnan(map.z[a])) continue;
      ++there;
      EXPECT_NEAR(map.z[a], other.value.z[b], 1e-12) << c << ' ' << r;
      EXPECT_NEAR(one.slope_x[a], turned ? other.slope_y[b] : other.slope_x[b], 1e-12) << c << ' ' << r;
      EXPECT_NEAR(one.slope_y[a], turned ? other.slope_x[b] : way_y * other.slope_y[b], 1e-12)
          << c << ' ' << r;
    }
  EXPECT_GT(there, map.width * map.height / 4);
}

TEST(HeightMap, IsSmoothedAlikeAlongBothAxesAndFromBothEnds) {
  for (const Borders borders : {Borders::kStay, Borders::kLeftOut})
    for (const double sigma : {0.7, 2.5}) {
      const HeightMap map = mapOf(40, 33, 1.0, 0.5, holedNoise);
      const SmoothMap smooth = smoothed(map, sigma, AtHoles::kFill, borders);
      const HeightMap turned = mapOf(33, 40, 0.5, 1.0, [&](int c, int r) { return map.at(r, c); });
      expectAlike(
          smooth, smoothed(turned, sigma, AtHoles::kFill, borders),
          [](int c, int r) { return std::pair(r, c); }, true, 1.0);
      const HeightMap upside_down = mapOf(40, 33, 1.0, 0.5, [&](int c, int r) { return map.at(c, 32 - r); });
      expectAlike(
          smooth, smoothed(upside_down, sigma, AtHoles::kFill, borders),
          [](int c, int r) { return std::pair(c, 32 - r); }, false, -1.0);
    }
}

TEST(HeightMap, APlaneStaysThatPlaneWithItsSlopes) {
  const auto plane = [](int c, int r) { return 3.0 + 0.25 * c - 0.5 * r; };
  const SmoothMap smooth = smoothed(
      mapOf(30, 28, 0.5, 2.0, [&](int c, int r) { return (c + r) % 9 == 4 ? std::nan("") : plane(c, r); }),
      3.0, AtHoles::kFill, Borders::kStay);
  int there = 0;
  for (int r = 0; r < 28; ++r)
    for (int c = 0; c < 30; ++c) {
      const std::size_t at = smooth.value.index(c, r);
      if (std::isnan(smooth.value.z[at])) continue;
      ++there;
      EXPECT_NEAR(smooth.value.z[at], plane(c, r), 1e-11);
      EXPECT_NEAR(smooth.slope_x[at], 0.5, 1e-11);
      EXPECT_NEAR(smooth.slope_y[at], -0.25, 1e-11);
    }
  EXPECT_GT(there, 300);
}

}  // namespace
}  // namespace fettle::engine
