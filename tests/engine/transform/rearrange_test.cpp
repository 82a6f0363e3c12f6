#include "engine/transform/rearrange.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "engine/field/builder.h"

namespace fettle::engine {
namespace {

// A field of random bits with holes, marks and a line, at a place of its own.
Version scan(std::int32_t width, std::int32_t height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = 0.25;
  grid.spacing_y = 1.0;
  grid.origin_x = 5e6;
  grid.origin_y = 4.5e6;
  grid.crs_wkt = "LOCAL_CS[\"here\"]";
  grid.height_per_count = 0.5;
  std::mt19937 random(static_cast<unsigned>(width));
  std::vector<float> z(static_cast<std::size_t>(grid.samples()));
  std::vector<std::uint8_t> marks(z.size());
  for (std::size_t i = 0; i < z.size(); ++i) {
    z[i] =
        random() % 11 == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(random()) * 1e-3F;
    marks[i] = random() % 7 == 0;
  }
  EdgeLine line;
  line.id = 4;
  for (int i = 0; i < 20; ++i) {
    EdgePoint p;
    p.position = {3.0 + i, 2.5 + 0.25 * i};
    p.located = true;
    p.step = 2.0;
    p.slope_change = 0.5;
    line.points.push_back(p);
  }
  return makeField(grid, z, marks).withLines(std::make_shared<const std::vector<EdgeLine>>(1, line));
}

bool same(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) ||
         (std::isnan(a) && std::isnan(b));
}

TEST(Cropped, HasTheSamplesMarksLinesAndPlacesOfItsRectangle) {
  const Version field = scan(200, 150);
  JobControl job;
  for (const SampleRect& rect :
       {SampleRect{5, 2, 130, 100}, {0, 0, 200, 150}, {199, 149, 1, 1}, {70, 0, 1, 150}}) {
    const auto piece = cropped(field, rect, job);
    ASSERT_TRUE(piece);
    const Grid &to = piece->grid(), &from = field.grid();
    ASSERT_EQ(to.width, rect.columns);
    ASSERT_EQ(to.height, rect.rows);
    EXPECT_EQ(to.crs_wkt, from.crs_wkt);
    EXPECT_EQ(to.height_per_count, from.height_per_count);
    for (int r = 0; r < rect.rows; ++r)
      for (int c = 0; c < rect.columns; ++c) {
        ASSERT_TRUE(
            same(piece->reader().heightAt(c, r), field.reader().heightAt(rect.column + c, rect.row + r)));
        ASSERT_EQ(piece->reader().markedAt(c, r), field.reader().markedAt(rect.column + c, rect.row + r));
      }
    EXPECT_EQ(to.origin_x, from.origin_x + rect.column * from.spacing_x);
    EXPECT_EQ(to.origin_y, from.origin_y + rect.row * from.spacing_y);
  }
  const auto piece = cropped(field, {5, 2, 130, 100}, job);
  ASSERT_TRUE(piece);
  EXPECT_EQ((*piece->lines())[0].id, 4);
  EXPECT_EQ((*piece->lines())[0].points[4].position,
            field.lines()->front().points[4].position - glm::dvec2(5, 2));
}

// A session refuses two lines of one number.
TEST(Cropped, OfALineThatIsCutIntoSeveralEachHasANumberOfItsOwn) {
  EdgeLine wave, other;
  wave.id = 4;
  other.id = 9;
  for (int i = 0; i < 180; ++i) {
    EdgePoint p;
    p.position = {5.0 + i, 60.0 + 20.0 * std::sin(i * 0.08)};
    wave.points.push_back(p);
    p.position.y = 75.0;
    other.points.push_back(p);
  }
  const Version field = scan(200, 150).withLines(
      std::make_shared<const std::vector<EdgeLine>>(std::vector<EdgeLine>{wave, other}));
  JobControl job;
  const auto piece = cropped(field, {0, 66, 200, 20}, job);
  ASSERT_TRUE(piece);
  std::set<std::int64_t> numbers;
  for (const EdgeLine& line : *piece->lines()) EXPECT_TRUE(numbers.insert(line.id).second) << line.id;
  EXPECT_GE(numbers.size(), 3U);
  EXPECT_EQ(piece->lines()->front().id, 4);
  EXPECT_TRUE(numbers.contains(9));
  // None is left where no line comes by.
  const auto plain = cropped(field, {0, 120, 200, 20}, job);
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->lines(), nullptr);
}

// Where a sample goes, one operation after the other, as it is written down.
struct Sample {
  int c, r, width, height;
  void mirrorX() { c = width - 1 - c; }
  void mirrorY() { r = height - 1 - r; }
  void quarter() {  // counter-clockwise: x to y, y to -x
    const int old_c = c;
    c = height - 1 - r;
    r = old_c;
    std::swap(width, height);
  }
};

TEST(Turned, MovesEverySampleMarkAndPointToWhereThePlainOperationsDo) {
  JobControl job;
  for (const auto& [width, height] : {std::pair{150, 97}, {64, 64}, {1, 80}, {80, 1}})
    for (int quarters = 0; quarters < 4; ++quarters)
      for (const bool mirror_x : {false, true})
        for (const bool mirror_y : {false, true}) {
          const Version field = scan(width, height).inverted();
          const auto moved = turned(field, {mirror_x, mirror_y, quarters}, job);
          ASSERT_TRUE(moved);
          const auto go = [&](int c, int r) {
            Sample s{c, r, width, height};
            if (mirror_x) s.mirrorX();
            if (mirror_y) s.mirrorY();
            for (int k = 0; k < quarters; ++k) s.quarter();
            return s;
          };
          const Sample size = go(0, 0);
          ASSERT_EQ(moved->grid().width, size.width);
          ASSERT_EQ(moved->grid().height, size.height);
          for (int r = 0; r < height; ++r)
            for (int c = 0; c < width; ++c) {
              const Sample s = go(c, r);
              ASSERT_TRUE(same(moved->reader().heightAt(s.c, s.r), field.reader().heightAt(c, r)));
              ASSERT_EQ(moved->reader().markedAt(s.c, s.r), field.reader().markedAt(c, r));
            }
          // Points at whole places go as the samples do.
          const EdgePoint &was = field.lines()->front().points[2], &is = moved->lines()->front().points[2];
          const Sample s = go(5, 3);
          EXPECT_EQ(was.position, glm::dvec2(5, 3));
          EXPECT_EQ(is.position, glm::dvec2(s.c, s.r));
          EXPECT_EQ(is.step, mirror_x != mirror_y ? -2.0 : 2.0);
          EXPECT_EQ(is.slope_change, 0.5);
          // The middle stays.
          const Grid &a = field.grid(), &b = moved->grid();
          EXPECT_NEAR(a.origin_x + 0.5 * (a.width - 1) * a.spacing_x,
                      b.origin_x + 0.5 * (b.width - 1) * b.spacing_x, 1e-8);
          EXPECT_NEAR(a.origin_y + 0.5 * (a.height - 1) * a.spacing_y,
                      b.origin_y + 0.5 * (b.height - 1) * b.spacing_y, 1e-8);
          EXPECT_EQ(b.spacing_x, quarters % 2 == 0 ? 0.25 : 1.0);
          EXPECT_EQ(b.crs_wkt.empty(), mirror_x || mirror_y || quarters != 0);
        }
}

TEST(Turned, FourTimesOrMirroredTwiceIsWhatItWas) {
  JobControl job;
  const Version field = scan(150, 97);
  Version four = field;
  for (int k = 0; k < 4; ++k) {
    const auto next = turned(four, {.quarters = 1}, job);
    ASSERT_TRUE(next);
    four = *next;
  }
  EXPECT_EQ(contentHash(four), contentHash(field));
  EXPECT_EQ(four.lines()->front().points[7].position, field.lines()->front().points[7].position);
  const auto once = turned(field, {.mirror_y = true}, job);
  ASSERT_TRUE(once);
  EXPECT_NE(contentHash(*once), contentHash(field));
  EXPECT_EQ(contentHash(*turned(*once, {.mirror_y = true}, job)), contentHash(field));
  job.cancel();
  EXPECT_EQ(turned(field, {.quarters = 1}, job).error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(cropped(field, {0, 0, 9, 9}, job).error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
