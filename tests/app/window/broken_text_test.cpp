#include "app/window/broken_text.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

// Every byte is as wide.
std::string broken(std::string_view text, float width) {
  return brokenText(text, width, [](std::string_view part) { return static_cast<float>(part.size()); });
}

TEST(BrokenText, lines_end_where_words_do) {
  EXPECT_EQ(broken("one two three", 20), "one two three");
  EXPECT_EQ(broken("one two three", 7), "one two\nthree");
  EXPECT_EQ(broken("one two three", 3), "one\ntwo\nthree");
  EXPECT_EQ(broken("", 3), "");
  EXPECT_EQ(broken("a\nbc de\n", 3), "a\nbc\nde\n") << "lines of the text stay";
}

TEST(BrokenText, a_number_stays_whole_and_with_its_unit) {
  EXPECT_EQ(broken("leaves 0.25 mm on flats", 10), "leaves\n0.25 mm on\nflats");
  EXPECT_EQ(broken("leaves 0.25 mm on flats", 12), "leaves\n0.25 mm on\nflats");
  EXPECT_EQ(broken("about 12 \u00b5m", 9), "about\n12 \u00b5m");
  EXPECT_EQ(broken("Box 11 x 11", 8), "Box\n11 x 11");
  EXPECT_EQ(broken("at 1000 samples", 8), "at 1000\nsamples") << "a word is no unit";
}

TEST(BrokenText, what_is_wider_than_a_line_has_one_of_its_own) {
  EXPECT_EQ(broken("so 123456.789 mm far", 5), "so\n123456.789 mm\nfar");
  EXPECT_EQ(broken("two  spaces", 4), "two \nspaces");
}

}  // namespace
}  // namespace fettle::app
