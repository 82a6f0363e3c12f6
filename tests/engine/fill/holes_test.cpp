#include "engine/fill/holes.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"

namespace fettle::engine {
namespace {

using Place = std::pair<std::int32_t, std::int32_t>;  // row, column

// The same by a search from sample to sample.
std::set<std::set<Place>> plainHoles(const FieldReader& field) {
  std::set<std::set<Place>> holes;
  std::set<Place> seen;
  const auto isHole = [&](std::int32_t r, std::int32_t c) {
    return field.grid().contains(c, r) && std::isnan(field.heightAt(c, r)) && !field.markedAt(c, r);
  };
  for (std::int32_t r = 0; r < field.height(); ++r)
    for (std::int32_t c = 0; c < field.width(); ++c) {
      if (!isHole(r, c) || !seen.insert({r, c}).second) continue;
      std::set<Place> hole;
      std::queue<Place> open({{r, c}});
      while (!open.empty()) {
        const Place p = open.front();
        open.pop();
        hole.insert(p);
        for (const Place& d : {Place{0, 1}, {0, -1}, {1, 0}, {-1, 0}}) {
          const Place n{p.first + d.first, p.second + d.second};
          if (isHole(n.first, n.second) && seen.insert(n).second) open.push(n);
        }
      }
      holes.insert(hole);
    }
  return holes;
}

TEST(Holes, AreThoseOfASearchFromSampleToSample) {
  std::mt19937 random(3);
  for (const auto& [width, height, share] : {std::tuple{200, 150, 0.05},
                                             {200, 150, 0.4},
                                             {130, 131, 0.6},
                                             {1, 90, 0.5},
                                             {90, 1, 0.5},
                                             {64, 64, 1.0}}) {
    Grid grid;
    grid.width = width;
    grid.height = height;
    std::vector<float> z(static_cast<std::size_t>(grid.samples()), 1.0F);
    std::vector<std::uint8_t> marks(z.size());
    std::uniform_real_distribution<double> uniform;
    for (std::size_t i = 0; i < z.size(); ++i) {
      if (uniform(random) < share) z[i] = std::numeric_limits<float>::quiet_NaN();
      marks[i] = uniform(random) < 0.03 ? 1 : 0;
    }
    const Version field = makeField(grid, z, marks);
    JobControl job;
    const auto found = findHoles(field, job);
    ASSERT_TRUE(found);
    std::set<std::set<Place>> sets;
    for (const Hole& hole : found->holes) {
      std::set<Place> samples;
      SampleRect box;
      bool at_border = false;
      for (const HoleRun& run : found->runsOf(hole)) {
        box = box.joined({run.first, run.row, run.samples(), 1});
        for (std::int32_t c = run.first; c <= run.last; ++c) {
          samples.insert({run.row, c});
          at_border = at_border || c == 0 || run.row == 0 || c == width - 1 || run.row == height - 1;
        }
      }
      EXPECT_EQ(static_cast<std::int64_t>(samples.size()), hole.samples);
      EXPECT_EQ(box, hole.box);
      EXPECT_EQ(at_border, hole.at_border);
      sets.insert(std::move(samples));
    }
    EXPECT_EQ(sets, plainHoles(field.reader())) << width << " x " << height << ", " << share;
  }
}

TEST(Holes, OfAFieldWithoutAnyAreNone) {
  Grid grid;
  grid.width = grid.height = 70;
  JobControl job;
  const auto found = findHoles(makeField(grid, std::vector<float>(4900, 2.0F)), job);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->holes.empty());
  job.cancel();
  const auto stopped = findHoles(makeField(grid, std::vector<float>(4900, 2.0F)), job);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
