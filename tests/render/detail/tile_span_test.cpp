#include "render/detail/tile_span.h"

#include <limits>
#include <memory>

#include <gtest/gtest.h>

namespace fettle::render {
namespace {

void expectSpan(const TileSpan& span, int c0, int r0, int c1, int r1) {
  EXPECT_EQ(span.first_column, c0);
  EXPECT_EQ(span.first_row, r0);
  EXPECT_EQ(span.last_column, c1);
  EXPECT_EQ(span.last_row, r1);
}

// What is drawn again of a tile: all that changed, and nothing around it.
TEST(TileSpan, IsTheRectangleAroundAllThatChanged) {
  const auto a = std::make_unique<engine::Tile>(), b = std::make_unique<engine::Tile>();
  EXPECT_TRUE(changedHeights(*a, *b).empty());
  EXPECT_TRUE(changedMarks(*a, *b).empty());
  const auto at = [](int column, int row) {
    return static_cast<std::size_t>(row * engine::kTileSide + column);
  };
  b->samples[at(7, 3)] = 1.0F;
  expectSpan(changedHeights(*a, *b), 7, 3, 7, 3);
  b->samples[at(2, 63)] = std::numeric_limits<float>::quiet_NaN();
  b->samples[at(63, 40)] = -0.0F;  // other bits, though an equal number
  expectSpan(changedHeights(*a, *b), 2, 3, 63, 63);
  EXPECT_TRUE(changedMarks(*a, *b).empty());
  *a = *b;
  EXPECT_TRUE(changedHeights(*a, *b).empty()) << "a hole that stays is no change";
  a->marks[5] = std::uint64_t{1} << 9;
  expectSpan(changedMarks(*a, *b), 9, 5, 9, 5);
  b->marks[0] = std::uint64_t{1} << 63;
  b->marks[63] = 1;
  expectSpan(changedMarks(*a, *b), 0, 0, 63, 63);
}

}  // namespace
}  // namespace fettle::render
