// Parts of a field that stand for the whole of it.
#include "engine/field/piece.h"
#include "engine/field/builder.h"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

// Heights that name their own place, every eleventh sample marked.
Version namedPlaces(std::int32_t width, std::int32_t height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = 0.5;
  grid.spacing_y = 2.0;
  std::vector<float> z;
  std::vector<std::uint8_t> marks;
  for (std::int32_t r = 0; r < height; ++r)
    for (std::int32_t c = 0; c < width; ++c) {
      z.push_back(static_cast<float>(1000 * r + c));
      marks.push_back((r + c) % 11 == 0 ? 1 : 0);
    }
  return makeField(grid, z, marks);
}

TEST(SpreadOver, HasSamplesFromAllOverTheFieldWithTheirMarks) {
  const Version field = namedPlaces(700, 130);
  const Version spread = spreadOver(field, 7, 5);
  ASSERT_EQ(spread.grid().width, 7);
  ASSERT_EQ(spread.grid().height, 5);
  EXPECT_DOUBLE_EQ(spread.grid().spacing_x, 50.0);
  EXPECT_DOUBLE_EQ(spread.grid().spacing_y, 52.0);
  std::vector<float> z(35);
  std::vector<std::uint8_t> marks(35);
  spread.reader().readHeights(0, 0, 7, 5, z.data(), 7);
  spread.reader().readMarks(0, 0, 7, 5, marks.data(), 7);
  for (int r = 0; r < 5; ++r)
    for (int c = 0; c < 7; ++c) {
      const auto k = static_cast<std::size_t>(7 * r + c);
      EXPECT_EQ(z[k], static_cast<float>(1000 * 26 * r + 100 * c));
      EXPECT_EQ(marks[k] != 0, (26 * r + 100 * c) % 11 == 0);
    }
}

TEST(SpreadOver, OfAsManySamplesIsTheField) {
  const Version field = namedPlaces(65, 3);
  const Version spread = spreadOver(field, 65, 3);
  std::vector<float> is(195), was(195);
  spread.reader().readHeights(0, 0, 65, 3, is.data(), 65);
  field.reader().readHeights(0, 0, 65, 3, was.data(), 65);
  EXPECT_EQ(is, was);
  EXPECT_EQ(spread.grid().spacing_x, field.grid().spacing_x);
}

TEST(SpreadOver, OfOneSample) {
  const Version one = spreadOver(namedPlaces(1, 1), 1, 1);
  float z = -1.0F;
  one.reader().readHeights(0, 0, 1, 1, &z, 1);
  EXPECT_EQ(z, 0.0F);
}

}  // namespace
}  // namespace fettle::engine
