// Tiles that are summed up as soon as they are whole are what they are when all wait for the end.
#include "engine/field/builder.h"
#include "tests/support/no_data.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

struct Window {
  std::int32_t column, row, columns, rows;
};

std::vector<float> someHeights(const Grid& grid) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> height(-3.0F, 3.0F);
  std::vector<float> z(static_cast<std::size_t>(grid.samples()));
  for (float& v : z) v = random() % 50 == 0 ? kNan : height(random);
  return z;
}

// Straight into the tiles, and reported where `reported`.
void writeAndReport(FieldBuilder& builder, const std::vector<float>& z, const Window& w, bool reported) {
  const std::int32_t width = builder.grid().width;
  for (std::int32_t tr = w.row / kTileSide; tr * kTileSide < w.row + w.rows; ++tr)
    for (std::int32_t tc = w.column / kTileSide; tc * kTileSide < w.column + w.columns; ++tc) {
      std::int32_t samples = 0;
      for (std::int32_t r = 0; r < kTileSide; ++r)
        for (std::int32_t c = 0; c < kTileSide; ++c) {
          const std::int32_t column = tc * kTileSide + c;
          const std::int32_t row = tr * kTileSide + r;
          if (column < w.column || column >= w.column + w.columns || row < w.row || row >= w.row + w.rows)
            continue;
          builder.tile(tc, tr).samples[static_cast<std::size_t>(r * kTileSide + c)] =
              z[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(column)];
          ++samples;
        }
      if (reported) builder.wrote(tc, tr, samples);
    }
}

void expectSameTiles(const Version& a, const Version& b) {
  const FieldReader x = a.reader();
  const FieldReader y = b.reader();
  EXPECT_EQ(x.bounds(), y.bounds());
  EXPECT_EQ(x.root().holed_children, y.root().holed_children);
  EXPECT_EQ(x.root().marked_children, y.root().marked_children);
  for (std::int32_t tr = 0; tr < x.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < x.tileColumns(); ++tc) {
      const Tile& p = x.tile(tc, tr);
      const Tile& q = y.tile(tc, tr);
      EXPECT_EQ(p.bounds, q.bounds) << tc << ' ' << tr;
      EXPECT_EQ(p.block_min, q.block_min) << tc << ' ' << tr;
      EXPECT_EQ(p.block_max, q.block_max) << tc << ' ' << tr;
      EXPECT_EQ(p.nan_samples, q.nan_samples) << tc << ' ' << tr;
      EXPECT_EQ(p.marked_samples, q.marked_samples) << tc << ' ' << tr;
      EXPECT_EQ(x.bounds(1, tc, tr), y.bounds(1, tc, tr)) << tc << ' ' << tr;
    }
  EXPECT_EQ(contentHash(a), contentHash(b));
}

TEST(FieldBuilder, TilesReportedWholeAreWhatTheEndMakesOfThem) {
  Grid grid;
  grid.width = 300;
  grid.height = 217;
  const std::vector<float> z = someHeights(grid);
  const Version plain = makeField(grid, z);
  // Windows that cut tiles anywhere.
  std::vector<Window> windows;
  for (std::int32_t row = 0; row < grid.height; row += 50)
    for (std::int32_t column = 0; column < grid.width; column += 90)
      windows.push_back({column, row, std::min(90, grid.width - column), std::min(50, grid.height - row)});
  for (const int unreported_each : {0, 1, 3}) {
    auto builder = FieldBuilder::create(grid, "field", FieldBuilder::Start::kUnwritten);
    ASSERT_TRUE(builder);
    std::mt19937 random(3);
    std::shuffle(windows.begin(), windows.end(), random);
    for (std::size_t i = 0; i < windows.size(); ++i)
      writeAndReport(*builder, z, windows[i],
                     unreported_each == 0 || i % static_cast<std::size_t>(unreported_each) != 0);
    expectSameTiles(std::move(*builder).build(), plain);
  }
}

TEST(FieldBuilder, ATileThatTwoThreadsFillIsSummedUpByTheLast) {
  Grid grid;
  grid.width = 256;
  grid.height = 512;
  const std::vector<float> z = someHeights(grid);
  const Version plain = makeField(grid, z);
  for (int round = 0; round < 20; ++round) {
    auto builder = FieldBuilder::create(grid, "field", FieldBuilder::Start::kUnwritten);
    ASSERT_TRUE(builder);
    const auto half = [&](std::int32_t begin) {  // every second row
      for (std::int32_t row = begin; row < grid.height; row += 2)
        writeAndReport(*builder, z, {0, row, grid.width, 1}, true);
    };
    std::thread other(half, 1);
    half(0);
    other.join();
    expectSameTiles(std::move(*builder).build(), plain);
  }
}

}  // namespace
}  // namespace fettle::engine
