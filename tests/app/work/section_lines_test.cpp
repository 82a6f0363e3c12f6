#include "app/work/section_lines.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace fettle::app
