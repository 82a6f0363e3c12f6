#include "engine/marks/polygon.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/field/builder.h"
#include "tests/support/no_data.h"

namespace fettle::engine {
namespace {

Version field(int width, int height, float z = 1.0F) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  return makeField(grid, std::vector<float>(static_cast<std::size_t>(width) * height, z));
}

// The rule as the header says it, one sample and one side at a time, in numbers with 64 bits of mantissa:
// exact, since corners here stay below 2^20 samples.
bool insideByHand(const std::vector<glm::dvec2>& corners, int column, int row) {
  std::vector<std::pair<long double, long double>> p;
  for (const glm::dvec2& c : corners)
    p.emplace_back(std::llround(c.x * Polygon::kSteps), std::llround(c.y * Polygon::kSteps));
  const long double x = (long double)column * Polygon::kSteps, y = (long double)row * Polygon::kSteps;
  bool inside = false;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto [ax, ay] = p[i];
    const auto [bx, by] = p[(i + 1) % p.size()];
    if ((ay <= y) == (by <= y)) continue;
    // At or right of the side: (x - ax)(by - ay) >= (y - ay)(bx - ax), for a side that goes up.
    const long double cross = (x - ax) * (by - ay) - (y - ay) * (bx - ax);
    if (by > ay ? cross >= 0 : cross <= 0) inside = !inside;
  }
  return inside;
}

Version marked(const Version& before, const std::vector<glm::dvec2>& corners,
               MarkChange change = MarkChange::kMark) {
  JobControl job;
  auto result = markPolygon(before, Polygon(corners), change, job);
  EXPECT_TRUE(result);
  return result.value_or(Version());
}

std::int64_t wrong(const Version& v, const std::vector<glm::dvec2>& corners) {
  std::int64_t n = 0;
  for (int r = 0; r < v.grid().height; ++r)
    for (int c = 0; c < v.grid().width; ++c) n += v.reader().markedAt(c, r) != insideByHand(corners, c, r);
  return n;
}

TEST(Polygon, any_line_marks_what_a_sample_by_sample_count_marks) {
  std::mt19937 random(7);
  const Version plain = field(203, 150);
  for (int n = 0; n < 60; ++n) {
    const bool on_samples = n % 3 == 0;  // corners and sides then go through samples
    std::uniform_real_distribution<double> x(-60.0, 260.0), y(-60.0, 210.0);
    std::vector<glm::dvec2> corners(3 + n % 20);
    for (glm::dvec2& c : corners) {
      c = {x(random), y(random)};
      if (on_samples) c = {std::round(c.x), std::round(c.y)};
    }
    EXPECT_EQ(wrong(marked(plain, corners), corners), 0) << "line " << n;
  }
}

TEST(Polygon, a_rectangle_with_corners_on_samples_keeps_its_left_and_lower_sides) {
  const Version v = marked(field(20, 20), {{3, 4}, {8, 4}, {8, 10}, {3, 10}});
  EXPECT_EQ(summarize(v).marked, 5 * 6);
  EXPECT_TRUE(v.reader().markedAt(3, 4));
  EXPECT_FALSE(v.reader().markedAt(8, 9));
  EXPECT_FALSE(v.reader().markedAt(7, 10));
}

TEST(Polygon, two_that_share_a_side_share_no_sample_and_leave_none_out) {
  const glm::dvec2 a{10.3, 5.1}, b{90.7, 77.9}, left{2.0, 80.0}, right{95.0, 3.0};
  JobControl job;
  const Version plain = field(100, 100);
  const Polygon p(std::vector<glm::dvec2>{a, b, left}), q(std::vector<glm::dvec2>{a, right, b}),
      both(std::vector<glm::dvec2>{a, right, b, left});
  for (std::int32_t tr = 0; tr < 2; ++tr)
    for (std::int32_t tc = 0; tc < 2; ++tc) {
      const MarkRows x = p.inside(tc, tr), y = q.inside(tc, tr), z = both.inside(tc, tr);
      for (std::size_t r = 0; r < x.size(); ++r) {
        EXPECT_EQ(x[r] & y[r], 0U);
        EXPECT_EQ(x[r] | y[r], z[r]);
      }
    }
}

TEST(Polygon, a_line_that_crosses_itself_leaves_out_what_it_goes_round_twice) {
  // A pentagram: its five points are inside, its middle is not.
  std::vector<glm::dvec2> star;
  for (int k = 0; k < 5; ++k) {
    const double a = 0.3 + k * 2.0 * 2.0 * 3.14159265358979 / 5.0;
    star.push_back({50.0 + 40.0 * std::cos(a), 50.0 + 40.0 * std::sin(a)});
  }
  const Version v = marked(field(100, 100), star);
  EXPECT_FALSE(v.reader().markedAt(50, 50));
  EXPECT_GT(summarize(v).marked, 500);
  EXPECT_EQ(wrong(v, star), 0);
}

TEST(Polygon, one_that_is_tiny_flat_or_elsewhere_marks_nothing_and_shares_every_tile) {
  const Version plain = field(70, 70);
  for (const std::vector<glm::dvec2>& corners : {std::vector<glm::dvec2>{},
                                                 {{1, 1}},
                                                 {{1, 1}, {5, 5}},
                                                 {{1, 1}, {9, 9}, {5, 5}},
                                                 {{10.1, 10.1}, {10.3, 10.1}, {10.3, 10.3}, {10.1, 10.3}},
                                                 {{1, 20}, {60, 20}, {30, 20}},
                                                 {{200, 200}, {300, 200}, {300, 300}},
                                                 {{-50, -50}, {-1, -50}, {-1, -1}}})
    EXPECT_EQ(marked(plain, corners), plain);
}

TEST(Polygon, one_around_the_field_marks_all_of_it_however_far_it_reaches) {
  const Version v = marked(field(130, 67), {{-1e9, -1e9}, {1e9, -1e9}, {1e9, 1e9}, {-1e9, 1e9}});
  EXPECT_EQ(summarize(v).marked, 130 * 67);
}

TEST(Polygon, a_corner_that_is_not_finite_is_left_out) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Version plain = field(30, 30);
  EXPECT_EQ(summarize(marked(plain, {{5, 5}, {nan, 3}, {15, 5}, {15, 15}, {5, 15}})).marked, 100);
}

TEST(Polygon, holes_are_not_marked_and_are_unmarked_like_all_others) {
  Grid grid;
  grid.width = grid.height = 40;
  std::vector<float> z(1600, 2.0F);
  for (int c = 10; c < 30; ++c) z[20 * 40 + c] = kNan;
  std::vector<std::uint8_t> marks(1600, 0);
  marks[20 * 40 + 12] = 1;
  const std::vector<glm::dvec2> all{{-1, -1}, {41, -1}, {41, 41}, {-1, 41}};
  const Version v = marked(makeField(grid, z, marks), all);
  EXPECT_EQ(summarize(v).marked, 1600 - 20 + 1);
  EXPECT_FALSE(v.reader().markedAt(15, 20));
  EXPECT_EQ(summarize(marked(v, all, MarkChange::kUnmark)).marked, 0);
}

TEST(Polygon, marking_and_unmarking_leave_heights_and_other_tiles_alone) {
  const Version plain = field(300, 300);
  const std::vector<glm::dvec2> box{{70, 70}, {100, 70}, {100, 100}, {70, 100}};
  const Version v = marked(plain, box);
  EXPECT_EQ(&v.reader().tile(0, 0), &plain.reader().tile(0, 0));
  EXPECT_NE(&v.reader().tile(1, 1), &plain.reader().tile(1, 1));
  EXPECT_EQ(contentHash(marked(v, box, MarkChange::kUnmark)), contentHash(plain));
}

TEST(Polygon, any_number_of_threads_marks_the_same_and_a_cancel_is_heard) {
  std::vector<glm::dvec2> round;
  for (int k = 0; k < 500; ++k)
    round.push_back({500 + (300 + 100 * std::sin(k * 0.7)) * std::cos(k * 0.01257),
                     500 + (300 + 100 * std::cos(k * 1.3)) * std::sin(k * 0.01257)});
  const Version plain = field(1000, 1000);
  const std::uint64_t many = contentHash(marked(plain, round));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(contentHash(marked(plain, round)), many);
  JobControl job;
  job.cancel();
  EXPECT_EQ(markPolygon(plain, Polygon(round), MarkChange::kMark, job).error().kind, ErrorKind::kCancelled);
}

TEST(ChangeMarks, inverting_twice_gives_the_marks_of_all_but_holes_back) {
  Grid grid;
  grid.width = 70;
  grid.height = 65;
  std::vector<float> z(70 * 65, 1.0F);
  std::vector<std::uint8_t> marks(z.size(), 0);
  std::mt19937 random(3);
  for (std::size_t i = 0; i < z.size(); ++i) {
    marks[i] = random() % 3 == 0;
    if (random() % 7 == 0) z[i] = kNan, marks[i] = 0;
  }
  JobControl job;
  const Version v = makeField(grid, z, marks);
  const Version inverted = *invertMarks(v, job);
  EXPECT_EQ(summarize(inverted).marked + summarize(v).marked + summarize(v).no_data, 70 * 65);
  EXPECT_EQ(contentHash(*invertMarks(inverted, job)), contentHash(v));
  EXPECT_EQ(summarize(*clearMarks(v, job)).marked, 0);
}

}  // namespace
}  // namespace fettle::engine
