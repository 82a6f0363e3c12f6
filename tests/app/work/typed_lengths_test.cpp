#include "app/work/typed_lengths.h"

#include <vector>

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

TEST(TypedLengths, ReadANumberWithOrWithoutAUnit) {
  EXPECT_EQ(typedLengthOf("0.5")->value, 0.5);
  EXPECT_EQ(typedLengthOf("0.5")->unit, "");
  EXPECT_EQ(typedLengthOf("-3 mm")->value, -3.0);
  EXPECT_EQ(typedLengthOf("20um")->unit_mm, 1e-3);
  EXPECT_EQ(typedLengthOf("1e-2in")->unit_mm, 25.4);
  EXPECT_FALSE(typedLengthOf("20q")->unit_mm);
  for (const char* none : {"", "mm", "nan", "inf", ",1"}) EXPECT_FALSE(typedLengthOf(none)) << none;
}

TEST(TypedLengths, SayWhatIsWrong) {
  EXPECT_EQ(lengthProblem("3mm"), "");
  EXPECT_EQ(lengthProblem("mm"), "mm is not a length");
  EXPECT_EQ(lengthProblem("3q").find("unknown unit q: take one of "), 0U);
}

TEST(TypedLengths, ReadPlacesInMillimetresOrInAnotherUnit) {
  EXPECT_EQ(lengthsOf("12.5mm,3mm", 2), (std::vector<double>{12.5, 3.0}));
  EXPECT_EQ(lengthsOf("1cm,500um", 2), (std::vector<double>{10.0, 0.5}));
  EXPECT_EQ(lengthsOf("-0.1,2", 2), (std::vector<double>{-0.1, 2.0}));
  // Of the world in metres: those without a unit keep every bit.
  EXPECT_EQ(lengthsOf("5000000.1,2km", 2, 1000.0), (std::vector<double>{5000000.1, 2000.0}));
  for (const char* other : {"1", "1,2,3", "1,", ",2", "1,2q", "1;2", "", "1,2,"})
    EXPECT_TRUE(lengthsOf(other, 2).empty()) << other;
}

}  // namespace
}  // namespace fettle::app
