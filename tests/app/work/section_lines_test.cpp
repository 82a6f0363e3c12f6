#include "app/work/section_lines.h"

#include <gtest/gtest.h>

#include "app/work/section_tool.h"
#include "tests/app/work/loop_client_bench.h"
#include "tests/haptic/support/fields.h"

namespace fettle::app {
namespace {

// Digits behind those of an error say nothing.
TEST(SectionLines, lengths_have_the_digits_of_their_errors) {
  Report of;
  of["step"] = {{"step_mm", 0.123456789}, {"step_error_mm", 0.00034}, {"edge_mm", 12.3456789},
                {"edge_error_mm", 0.021}, {"before", {0.1, 11.5}},    {"after", {13.0, 20.0}},
                {"rms_mm", 0.00123456789}};
  const SectionUnits units{{"mm", 1.0}, {"um", 0.001}};
  auto lines = sectionLines(of, units);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].text,
            "123.46 +- 0.34 um, edge at 12.346 +- 0.021 mm, by 0.1 to 11.5 mm and 13 to 20 mm, rms 1.235 um");
  // Of a session of before errors were stated: all digits that are known.
  of["step"].erase("edge_error_mm");
  lines = sectionLines(of, units);
  EXPECT_NE(lines[0].text.find("edge at 12.3457 mm,"), std::string::npos) << lines[0].text;
}

TEST(SectionLines, what_lies_between_cursors_has_the_digits_of_the_plot) {
  Report of;
  of["cursors"] = {{"dx_mm", 1.23456789},
                   {"dz_mm", 0.0123456789},
                   {"dz_error_mm", Report()},
                   {"slope_deg", 0.573049123},
                   {"distance_mm", 1.23462961}};
  auto lines = sectionLines(of, {{"mm", 1.0}, {"um", 0.001}});
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].text, "dx 1.2346 mm, dz 12.346 um, slope 0.57305 degrees, distance 1.2346 mm");
  of["cursors"]["dz_error_mm"] = 0.0021;
  lines = sectionLines(of, {{"mm", 1.0}, {"um", 0.001}});
  EXPECT_NE(lines[0].text.find("dz 12.3 +- 2.1 um,"), std::string::npos) << lines[0].text;
}

TEST(SectionLines, a_cursor_over_a_hole_is_said_in_a_sentence) {
  tests::LoopClientBench bench{tests::fieldOf(
      60, 20, [](int c, int) { return c > 40 ? static_cast<double>(tests::kHole) : 0.01 * c; })};
  SectionTool tool;
  tool.setFrom({2.0, 10.0});
  tool.setTo({55.0, 10.0});
  KeptSection section = *tool.section();
  section.cursors = {5.0, 50.0};
  tool.set(section);
  ASSERT_TRUE(bench.until([&] {
    (void)tool.poll(bench.client(), bench.noticesToFill());
    return !tool.busy();
  }));
  ASSERT_FALSE(tool.figures().now.empty());
  EXPECT_EQ(tool.figures().now.front().name, "cursors");
  EXPECT_EQ(tool.figures().now.front().text, "not stated: the second cursor is over a hole");
}

}  // namespace
}  // namespace fettle::app
