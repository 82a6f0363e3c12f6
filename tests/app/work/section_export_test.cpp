#include "app/work/section_export.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/plots/gnuplot.h"
#include "tests/haptic/support/fields.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

std::vector<std::string> linesOf(const std::string& path) {
  std::ifstream in(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string bytesOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// A step of 0.5 mm in the middle of 41 x 21 samples, 0.1 mm apart.
engine::Version stepField(double lifted = 0.0) {
  return tests::fieldOf(
      41, 21, [&](int c, int) { return (c < 20 ? 0.0 : 0.5) + lifted; }, 0.1, 0.1);
}

KeptSection along(double y, double from, double to) {
  KeptSection section;
  section.from = {from, y};
  section.to = {to, y};
  section.placeStretches();
  return section;
}

class SectionExport : public ::testing::Test {
 protected:
  engine::Status write(const char* name) {
    engine::JobControl job;
    return writeSections(what, folder.file(name), job);
  }
  tests::TempFolder folder;
  SectionsToWrite what{{along(1.0, 0.0, 4.0), along(0.5, 1.0, 3.0)}, stepField(), {}};
};

TEST_F(SectionExport, a_table_has_a_row_for_each_place_of_each_section) {
  ASSERT_TRUE(write("s.csv"));
  const std::vector<std::string> lines = linesOf(folder.file("s.csv"));
  // Places lie one sample apart: 41 along 4 mm, 21 along 2 mm.
  ASSERT_EQ(lines.size(), 1U + 41U + 21U);
  EXPECT_EQ(lines[0], "section,along_mm,x_mm,y_mm,height_mm,share,interpolation,layer");
  EXPECT_EQ(lines[1], "0,0,0,1,0,1,bilinear,");
  EXPECT_EQ(lines[41], "0,4,4,1,0.5,1,bilinear,");
  EXPECT_EQ(lines[42], "1,0,1,0.5,0,1,bilinear,");
}

TEST_F(SectionExport, profiles_of_the_scan_stand_beside_them_and_are_empty_where_it_has_none) {
  what.before = tests::fieldOf(
      41, 21, [](int, int r) { return r < 8 ? std::nan("") : 0.25; }, 0.1, 0.1);
  ASSERT_TRUE(write("s.csv"));
  const std::vector<std::string> lines = linesOf(folder.file("s.csv"));
  ASSERT_EQ(lines.size(), 1U + 41U + 21U);
  EXPECT_EQ(lines[0], "section,along_mm,x_mm,y_mm,height_mm,share,other_mm,interpolation,layer,other_layer");
  EXPECT_EQ(lines[1], "0,0,0,1,0,1,0.25,bilinear,,");
  EXPECT_EQ(lines[42], "1,0,1,0.5,0,1,,bilinear,,") << "no height of the scan along the second line";
}

TEST_F(SectionExport, polylines_are_a_layer_for_each) {
  ASSERT_TRUE(write("s.dxf"));
  const std::string text = bytesOf(folder.file("s.dxf"));
  for (const char* layer : {"SECTION_0", "SECTION_1"})
    EXPECT_NE(text.find(layer), std::string::npos) << layer;
  EXPECT_EQ(text.find("_OTHER"), std::string::npos);
  EXPECT_TRUE(text.ends_with("0\nEOF\n"));
}

TEST_F(SectionExport, drawings_are_what_the_ending_says) {
  if (!plotsCanBeMade()) GTEST_SKIP() << "gnuplot is not installed";
  ASSERT_TRUE(write("s.svg"));
  ASSERT_TRUE(write("s.png"));
  EXPECT_TRUE(bytesOf(folder.file("s.svg")).starts_with("<svg"));
  EXPECT_NE(bytesOf(folder.file("s.svg")).find("cursor"), std::string::npos) << "what was measured at";
  EXPECT_TRUE(bytesOf(folder.file("s.png")).starts_with("\x89PNG"));
}

TEST_F(SectionExport, what_cannot_be_written_leaves_no_file) {
  const auto refused = [&](const char* name) {
    const auto status = write(name);
    EXPECT_FALSE(std::filesystem::exists(folder.file(name)));
    return status ? engine::Error{} : status.error();
  };
  EXPECT_EQ(refused("s.xyz").kind, engine::ErrorKind::kInput);
  what.sections[1] = along(50.0, 0.0, 4.0);
  const engine::Error outside = refused("s.csv");
  EXPECT_EQ(outside.kind, engine::ErrorKind::kInput);
  EXPECT_EQ(outside.where, "section 2");
  what.sections.pop_back();
  engine::JobControl job;
  job.cancel();
  const auto cancelled = writeSections(what, folder.file("s.csv"), job);
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().kind, engine::ErrorKind::kCancelled);
  EXPECT_FALSE(std::filesystem::exists(folder.file("s.csv")));
}

}  // namespace
}  // namespace fettle::app
