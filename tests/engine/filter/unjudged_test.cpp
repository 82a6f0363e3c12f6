// What outliers cannot judge keeps its height however far it stands apart; everything else is judged.
#include "engine/filter/unjudged.h"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"

namespace fettle::engine {
namespace {

// A field of a picture: `.` a hole, anything else a sample.
Version fieldDrawn(const std::vector<std::string>& picture, float lone = 0.0F) {
  Grid grid;
  grid.height = static_cast<std::int32_t>(picture.size());
  grid.width = static_cast<std::int32_t>(picture.front().size());
  std::vector<float> z;
  for (const std::string& row : picture)
    for (const char c : row)
      z.push_back(c == '.' ? std::numeric_limits<float>::quiet_NaN() : c == 'X' ? lone : 0.0F);
  return makeField(grid, z, {});
}

std::int64_t unjudgedIn(const std::vector<std::string>& picture, int window = 3) {
  FilterSpec spec;
  spec.kind = FilterKind::kOutliers;
  spec.window = window;
  JobControl job;
  return countUnjudged(fieldDrawn(picture), spec, job).value_or(-1);
}

TEST(Unjudged, AWholeFieldHasNone) {
  EXPECT_EQ(unjudgedIn({"oooo", "oooo", "oooo"}), 0) << "corners have three that are not on one line";
}

TEST(Unjudged, LoneOnesAndEndsOfThinStripsAreCounted) {
  EXPECT_EQ(unjudgedIn({"....", ".o..", "...."}), 1);
  EXPECT_EQ(unjudgedIn({".....", ".ooo.", "....."}), 2) << "the middle has two opposite each other";
  EXPECT_EQ(unjudgedIn({".....", ".oo..", ".o..."}), 3) << "two others each";
  EXPECT_EQ(unjudgedIn({".....", ".oo..", ".oo.."}), 0) << "three others each";
  EXPECT_EQ(unjudgedIn({".....", ".ooo.", "....."}, 5), 2) << "both others on one line";
  EXPECT_EQ(unjudgedIn({"oooo"}), 2);
}

// It is what the filter does: a sample that it cannot judge stays, and one that it can goes, wherever it is put.
TEST(Unjudged, IsWhereSpikesStay) {
  const std::vector<std::string> picture = {"oo.o.o....", "o.oo..oo..", "..o.ooo.o.", "o..oo.o..o",
                                            ".o...oo.oo"};
  FilterSpec spec;
  spec.kind = FilterKind::kOutliers;
  spec.window = 3;
  spec.range_sigma = 0.1;
  JobControl job;
  std::int64_t stay = 0;
  for (std::size_t r = 0; r < picture.size(); ++r)
    for (std::size_t c = 0; c < picture[r].size(); ++c) {
      if (picture[r][c] == '.') continue;
      std::vector<std::string> with = picture;
      with[r][c] = 'X';
      const Version field = fieldDrawn(with, 50.0F);
      const auto done = applyFilter(field, field, spec, job);
      ASSERT_TRUE(done);
      stay +=
          done->field.reader().heightAt(static_cast<std::int32_t>(c), static_cast<std::int32_t>(r)) == 50.0F;
    }
  EXPECT_EQ(countUnjudged(fieldDrawn(picture), spec, job), stay);
  EXPECT_GT(stay, 0);
}

TEST(Unjudged, MarksThatAreKeptAreNotAskedFor) {
  const Version field = fieldDrawn({"....", ".o..", "...."});
  FilterSpec spec;
  spec.kind = FilterKind::kOutliers;
  spec.window = 3;
  spec.scope = FilterScope::kOnlyMarks;
  JobControl job;
  EXPECT_EQ(countUnjudged(field, spec, job), 0);
}

}  // namespace
}  // namespace fettle::engine
