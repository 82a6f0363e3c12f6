#include "engine/suggest/continued_paths.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

namespace fettle::engine {
namespace {

using Path = std::vector<glm::dvec2>;

Path straight(glm::dvec2 from, glm::dvec2 to) {
  Path path;
  const int pieces = static_cast<int>(glm::distance(from, to));
  for (int i = 0; i <= pieces; ++i) path.push_back(from + (to - from) * (static_cast<double>(i) / pieces));
  return path;
}

double widestGap(const Path& path) {
  double widest = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i)
    widest = std::max(widest, glm::distance(path[i - 1], path[i]));
  return widest;
}

TEST(ContinuedPaths, a_gap_in_a_straight_line_is_filled_whichever_way_the_pieces_run) {
  for (const bool turned : {false, true}) {
    Path second = straight({100, 20}, {160, 20});
    if (turned) std::ranges::reverse(second);
    const auto chains = continuedPaths({straight({0, 20}, {50, 20}), second});
    ASSERT_EQ(chains.size(), 1U);
    EXPECT_NEAR(glm::distance(chains[0].front(), chains[0].back()), 160.0, 1e-9);
    EXPECT_LE(widestGap(chains[0]), 1.0 + 1e-9);
  }
}

TEST(ContinuedPaths, corners_are_joined_when_they_are_near) {
  EXPECT_EQ(continuedPaths({straight({0, 0}, {50, 0}), straight({55, 5}, {55, 60})}).size(), 1U);
  EXPECT_EQ(continuedPaths({straight({0, 0}, {50, 0}), straight({80, 30}, {80, 90})}).size(), 2U);
}

TEST(ContinuedPaths, lines_beside_each_other_stay_apart) {
  EXPECT_EQ(continuedPaths({straight({0, 0}, {100, 0}), straight({0, 20}, {100, 20})}).size(), 2U);
  EXPECT_EQ(continuedPaths({straight({0, 0}, {100, 0}), straight({0, 8}, {100, 8})}).size(), 2U)
      << "ends beside each other turn back";
}

TEST(ContinuedPaths, an_end_is_joined_once_and_a_ring_of_pieces_ends) {
  const auto ring = continuedPaths({straight({0, 0}, {40, 0}), straight({45, 5}, {45, 45}),
                                    straight({40, 50}, {0, 50}), straight({-5, 45}, {-5, 5})});
  ASSERT_EQ(ring.size(), 1U);
  EXPECT_EQ(
      continuedPaths({straight({0, 0}, {40, 0}), straight({60, 0}, {99, 0}), straight({60, 4}, {99, 4})})
          .size(),
      2U);
}

TEST(ContinuedPaths, nothing_and_single_points_are_no_trouble) {
  EXPECT_TRUE(continuedPaths({}).empty());
  EXPECT_TRUE(continuedPaths({{}, {}}).empty());
  EXPECT_EQ(continuedPaths({{{1, 1}}, {{1, 1}}}).size(), 1U);
  EXPECT_EQ(continuedPaths({{{1, 1}}, {{900, 1}}}).size(), 2U);
}

}  // namespace
}  // namespace fettle::engine
