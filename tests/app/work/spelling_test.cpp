#include "app/work/spelling.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

const std::vector<std::string> kFilters{"box", "gaussian", "median", "bilateral", "tv"};

TEST(Spelling, TheNearestWordIsFoundByWrongMissingSwappedAndSpareLetters) {
  for (const char* typed : {"gausian", "gaussain", "gaussiann", "GAUSSIAN", "gauss", "gaussion"})
    EXPECT_EQ(nearest(typed, kFilters), "gaussian") << typed;
  EXPECT_EQ(nearest("bxo", kFilters), "box");
  EXPECT_EQ(nearest("vt", kFilters), "tv");
  EXPECT_EQ(didYouMean("meidan", kFilters), "did you mean median?");
}

TEST(Spelling, WhatIsFarFromAllOrAsNearToTwoIsNotGuessed) {
  for (const char* typed : {"", "sharpen", "g", "zzzzzzzz"})
    EXPECT_EQ(nearest(typed, kFilters), std::nullopt) << typed;
  EXPECT_EQ(nearest("cat", {"bat", "hat"}), std::nullopt);
  EXPECT_EQ(nearest(std::string(100000, 'x'), kFilters), std::nullopt);
  EXPECT_EQ(didYouMean("sharpen", kFilters), "");
}

}  // namespace
}  // namespace fettle::app
