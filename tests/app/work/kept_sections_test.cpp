#include "app/work/kept_sections.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

TEST(KeptSections, ComeBackToTheSameBits) {
  KeptSection first;
  first.from = {0.1, 1.0 / 3.0};
  first.to = {5e6, -7.25e-9};
  first.width_mm = 0.3;
  first.cursors = {4.0, 0.7};
  first.step = first.roughness = true;
  first.cutoff_mm = 0.8;
  KeptSection second;
  second.to = {1.0, 0.0};
  second.line = second.groove = second.arc = true;
  KeptSection third = first;
  third.angle = true;
  third.others = {0.8, 1.0 / 7.0};
  const std::vector<KeptSection> kept = {first, second, third};
  const auto read = sectionsOf(sectionsText(kept));
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(*read, kept);
  EXPECT_TRUE(sectionsOf(sectionsText({}))->empty());
}

TEST(KeptSections, AreRefusedWhereTheTextIsNone) {
  for (const char* text :
       {"", "{}1", "[1]", "[{}]", R"([{"from":[0,0],"to":[1,1e999]}])",
        R"([{"from":[0],"to":[1,1],"width_mm":0,"cursors_mm":[0,1],"figures":[],"cutoff_mm":0}])",
        R"([{"from":[0,0],"to":[1,1],"width_mm":"x","cursors_mm":[0,1],"figures":[],"cutoff_mm":0}])"})
    EXPECT_FALSE(sectionsOf(text)) << text;
}

TEST(KeptSections, AreMeasuredBetweenTheirCursors) {
  KeptSection section;
  section.to = {10.0, 0.0};
  section.cursors = {8.0, 2.0};
  section.step = section.arc = section.roughness = true;
  SectionWants wants = wantsOf(section);
  EXPECT_EQ(wants.cursors, (std::vector<double>{8.0, 2.0})) << "dz has a sense";
  EXPECT_EQ(wants.within, (std::vector<double>{2.0, 8.0}));
  EXPECT_EQ(wants.arc, wants.within);
  EXPECT_EQ(wants.step, "auto");
  EXPECT_TRUE(wants.groove.empty());
  EXPECT_FALSE(wants.cutoff) << "none is given";
  section.cutoff_mm = 0.25;
  EXPECT_EQ(wantsOf(section).cutoff, 0.25);
  section.cursors = {3.0, 3.0};
  wants = wantsOf(section);
  EXPECT_TRUE(wants.within.empty());
  EXPECT_TRUE(wants.step.empty()) << "nothing lies between the cursors";
}

TEST(KeptSections, WrittenBeforeThereWasASecondStretchAreRead) {
  const auto read = sectionsOf(
      R"([{"from":[0,0],"to":[1,1],"width_mm":0,"cursors_mm":[0,1],"figures":["arc"],"cutoff_mm":0}])");
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_TRUE(read->front().arc);
  EXPECT_FALSE(read->front().angle);
  EXPECT_EQ(read->front().others.first, read->front().others.second);
}

TEST(KeptSections, AnAngleIsThatOfBothStretches) {
  KeptSection section;
  section.to = {10.0, 0.0};
  section.angle = true;
  section.placeStretches();
  EXPECT_EQ(wantsOf(section).angle, (std::vector<double>{1.0, 4.0, 6.0, 9.0}));
  section.others = {9.0, 7.0};
  section.cursors = {4.0, 1.0};
  EXPECT_EQ(wantsOf(section).angle, (std::vector<double>{1.0, 4.0, 7.0, 9.0})) << "each from its nearer end";
  section.others = {9.0, 9.0};
  EXPECT_TRUE(wantsOf(section).angle.empty()) << "a stretch of one place has no line";
  // The longer part beside the first.
  section.placeSecond();
  EXPECT_EQ(section.others, (std::pair{4.6, 9.4}));
  section.cursors = {5.0, 9.0};
  section.others = {0.0, 0.0};
  section.placeSecond();
  EXPECT_EQ(section.others, (std::pair{0.5, 4.5}));
  section.placeSecond();
  EXPECT_EQ(section.others, (std::pair{0.5, 4.5})) << "only where there is none";
  section.angle = false;
  EXPECT_TRUE(wantsOf(section).angle.empty());
}

}  // namespace
}  // namespace fettle::app
