#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/formats/formats.h"
#include "engine/io/raster/marks.h"
#include "engine/marks/edge_suggestion.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

class MarkCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(fettle({"synth", scan, "--size", "300x240", "--seed", "3"}).status, 0);
    engine::JobControl job;
    auto imported = engine::importField(scan, {}, job);
    ASSERT_TRUE(imported) << imported.error().line();
    field = imported->field;
  }
  [[nodiscard]] engine::Version read(const std::string& path) const {
    auto marked = engine::importMarks(field, path);
    EXPECT_TRUE(marked);
    return marked.value_or(field);
  }

  TempFolder folder;
  std::string scan = (folder.path() / "scan.tif").string();
  std::string marks = (folder.path() / "marks.png").string();
  engine::Version field;
};

TEST_F(MarkCommand, edges_are_those_that_the_window_suggests) {
  const auto report = fettleJson(
      {"mark", scan, marks, "--edges", "--scale", "2", "--sensitivity", "0.6", "--thickness", "1.5"});
  engine::JobControl job;
  const auto map = engine::findEdges(field, 2.0, job);
  ASSERT_TRUE(map);
  const auto expected = engine::suggestMarks(field, *map, {0.6, 1.5, 0}, job);
  ASSERT_TRUE(expected);
  EXPECT_GT(expected->lines, 3);
  EXPECT_EQ(engine::contentHash(read(marks)), engine::contentHash(expected->field));
  EXPECT_EQ(report["lines"], expected->lines);
  EXPECT_EQ(report["marked"], engine::summarize(expected->field).marked);
}

TEST_F(MarkCommand, strokes_outside_the_scan_are_refused_before_anything_is_written) {
  const std::string strokes = folder.file("strokes.csv"), lines = folder.file("lines.csv");
  std::ofstream file(strokes);
  file << "t,x,y,z,tool\n";
  for (int i = 0; i < 40; ++i) file << 0.001 * i << ',' << -900.0 + 0.05 * i << ",5,0,mark\n";
  file.close();
  expectRefused(fettle({"mark", scan, marks, "--strokes", strokes, "--lines-out", lines}),
                "all strokes of the tool mark lie outside the scan");
  EXPECT_FALSE(std::filesystem::exists(lines));
  EXPECT_FALSE(std::filesystem::exists(marks));
}

TEST_F(MarkCommand, strokes_outside_the_scan_beside_others_are_left_out_and_named) {
  const std::string strokes = folder.file("strokes.csv"), lines = folder.file("lines.csv");
  std::ofstream file(strokes);
  file << "t,x,y,z,tool\n";
  for (const double x : {2.0, -900.0}) {
    for (int i = 0; i < 40; ++i) file << 0.001 * i << ',' << x + 0.2 * i << ",5,0,mark\n";
    file << "0.1," << x << ",5,9,feel\n";
  }
  file.close();
  const auto report = fettleJson({"mark", scan, marks, "--strokes", strokes, "--lines-out", lines});
  EXPECT_EQ(report["lines"], 1);
  ASSERT_EQ(report["warnings"].size(), 1U);
  EXPECT_NE(report["warnings"][0].get<std::string>().find("1 of 2 strokes"), std::string::npos);
}

TEST_F(MarkCommand, marks_can_be_added_to_and_inverted) {
  ASSERT_EQ(fettle({"mark", scan, marks, "--edges"}).status, 0);
  const std::string inverted = (folder.path() / "inverted.tif").string();
  ASSERT_EQ(fettle({"mark", scan, inverted, "--add", marks, "--invert"}).status, 0);
  const engine::FieldSummary a = engine::summarize(read(marks)), b = engine::summarize(read(inverted));
  EXPECT_EQ(a.marked + b.marked, 300 * 240 - a.no_data);
}

TEST_F(MarkCommand, marks_are_added_to_those_that_are_made_and_alone_written_in_another_format) {
  // Left third by hand, in a picture of its own: some of the edges are in it, some are not.
  std::vector<std::uint8_t> left(300 * 240);
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i % 300 < 100 ? 1 : 0;
  std::vector<float> heights(left.size());
  field.reader().readHeights(0, 0, 300, 240, heights.data(), 300);
  const engine::Version by_hand = engine::makeField(field.grid(), heights, left);
  const std::string hand = folder.file("hand.png"), both = folder.file("both.png"),
                    other = folder.file("hand.tif");
  ASSERT_TRUE(engine::exportMarks(by_hand, hand));
  ASSERT_EQ(fettle({"mark", scan, marks, "--edges"}).status, 0);
  const auto report = fettleJson({"mark", scan, both, "--edges", "--add", hand});
  const auto alone = fettleJson({"mark", scan, other, "--add", hand});
  const auto marksOf = [](const engine::Version& marked) {
    std::vector<std::uint8_t> read(300 * 240);
    marked.reader().readMarks(0, 0, 300, 240, read.data(), 300);
    return read;
  };
  const std::vector<std::uint8_t> edges = marksOf(read(marks)), added = marksOf(read(both));
  const std::vector<std::uint8_t> hands = marksOf(read(hand));
  EXPECT_EQ(marksOf(read(other)), hands);
  int in_both = 0, in_one = 0;
  for (std::size_t i = 0; i < added.size(); ++i) {
    ASSERT_EQ(added[i], edges[i] | hands[i]) << i;
    in_both += edges[i] & hands[i];
    in_one += edges[i] ^ hands[i];
  }
  EXPECT_GT(in_both, 100);
  EXPECT_GT(in_one, 1000);
  EXPECT_EQ(report["marked"], in_both + in_one);
  EXPECT_EQ(alone["marked"], std::accumulate(hands.begin(), hands.end(), 0));
  ASSERT_EQ(fettle({"synth", folder.file("small.tif"), "--size", "64x64"}).status, 0);
  expectRefused(fettle({"mark", folder.file("small.tif"), folder.file("m.png"), "--add", hand}), "hand.png");
  expectRefused(fettle({"mark", scan, hand, "--edges", "--add", hand}), "hand.png");
}

TEST_F(MarkCommand, what_cannot_be_done_is_refused) {
  expectRefused(fettle({"mark", scan, marks}), "--edges");
  expectRefused(fettle({"mark", scan, marks, "--edges", "--scale", "99"}), "scale");
  expectRefused(fettle({"mark", scan, marks, "--edges", "--sensitivity", "nan"}), "sensitivity");
  expectRefused(fettle({"mark", scan, (folder.path() / "marks.txt").string(), "--edges"}), "marks.txt");
}

}  // namespace
}  // namespace fettle::tests
