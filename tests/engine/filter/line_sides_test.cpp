// On which side of a line samples are put.
#include "engine/filter/line_sides.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/filter/edge_line_of.h"

namespace fettle::engine::tests {
namespace {

constexpr int kSide = 24;

// A block of a field amid others, with a wall of 100 noises along x or y, between samples 9 and 10 of the block.
struct Walled {
  bool along_x = false;
  std::int32_t left = 0, low = 0;
  std::vector<float> heights = std::vector<float>(kSide * kSide);

  // The sample so far across the wall and so far along it.
  [[nodiscard]] LoneSample sample(int across, int along) const {
    return along_x ? LoneSample{along, across, 0.0F} : LoneSample{across, along, 0.0F};
  }
  float& height(const LoneSample& s) { return heights[static_cast<std::size_t>(s.row * kSide + s.column)]; }
};

// Whether the wall still passes each of its samples, after lone samples were settled.
std::vector<bool> wallAfter(Walled& walled, double at, std::vector<LoneSample>& lone) {
  for (int across = 0; across < kSide; ++across)
    for (int along = 0; along < kSide; ++along)
      walled.height(walled.sample(across, along)) = across < 10 ? 0.0F : 100.0F;
  for (const LoneSample& s : lone) walled.height(s) = 50.0F;
  // The line begins with the block, so that no row of the field before it is cut.
  const double x = (walled.along_x ? walled.low : walled.left) + at;
  const double from = (walled.along_x ? walled.left : walled.low) - 0.5, to = from + 60.0;
  const LineCuts cuts(std::vector{walled.along_x ? edgeLineOf({{from, x}, {to, x}}, 0.3)
                                                 : edgeLineOf({{x, from}, {x, to}}, 0.3)},
                      100, 100);
  Block block;
  block.columns = block.rows = kSide;
  block.cuts = &cuts;
  block.left = walled.left;
  block.low = walled.low;
  LineSides sides;
  EXPECT_TRUE(sides.take(block));
  sides.settle(walled.heights.data(), kSide, lone);
  std::vector<bool> wall(kSide, false);
  sides.forEachCut([&](std::int32_t c, std::int32_t r, std::uint8_t links) {
    if ((walled.along_x ? r : c) == 9 && (links & (walled.along_x ? LineCut::kUp : LineCut::kRight)) != 0)
      wall[static_cast<std::size_t>(walled.along_x ? c : r)] = true;
  });
  return wall;
}

TEST(LineSides, ALoneSampleIsJoinedToBothSidesWhereTheLineIsNearerThanItMayBeOff) {
  for (const bool along_x : {false, true})
    for (const auto& [at, near_across] : {std::pair{9.9, 10}, {9.1, 9}}) {
      Walled walled{along_x, 16, 24};
      // Two beside the line, one sample along it from each other: a tenth from it and nine tenths.
      std::vector<LoneSample> lone{walled.sample(9, 6), walled.sample(10, 15)};
      const std::vector<bool> wall = wallAfter(walled, at, lone);
      for (int along = 0; along < kSide; ++along) {
        const bool near = near_across == 9 ? along == 6 : along == 15;
        EXPECT_EQ(wall[static_cast<std::size_t>(along)], !near) << along_x << ' ' << at << ' ' << along;
      }
      // The other one has the height of the side where the line has it.
      EXPECT_EQ(lone[near_across == 9 ? 1 : 0].between, near_across == 9 ? 100.0F : 0.0F);
    }
}

}  // namespace
}  // namespace fettle::engine::tests
