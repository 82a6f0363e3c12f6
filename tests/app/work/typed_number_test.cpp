#include "app/work/typed_number.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

TEST(TypedNumber, reads_as_people_write) {
  for (const char* text : {"12.5", "12,5", " +12.5 ", "1.25e1", "1,25e1"}) {
    const auto typed = readTypedNumber(text);
    ASSERT_TRUE(typed) << text;
    EXPECT_EQ(typed->number, 12.5) << text;
    EXPECT_EQ(typed->unit, "") << text;
  }
  const auto with_unit = readTypedNumber("-0,25  N/mm ");
  ASSERT_TRUE(with_unit);
  EXPECT_EQ(with_unit->number, -0.25);
  EXPECT_EQ(with_unit->unit, "N/mm");
}

TEST(TypedNumber, is_none_where_it_is_not_clear) {
  for (const char* text :
       {"", " ", "+", "mm", "1,234.5", "1.234,5", "1,234,567", "inf", "nan", "1e999", ",", "-"})
    EXPECT_FALSE(readTypedNumber(text)) << text;
}

TEST(TypedNumber, of_a_length_is_in_the_unit_behind_it) {
  EXPECT_DOUBLE_EQ(*readTypedLength("2,5", "nm"), 2.5);
  EXPECT_DOUBLE_EQ(*readTypedLength("2,5mm", "\u00b5m"), 2500.0);
  EXPECT_DOUBLE_EQ(*readTypedLength("3 counts", "counts"), 3.0);
  EXPECT_FALSE(readTypedLength("3 parsecs", "mm"));
  EXPECT_FALSE(readTypedLength("mm", "mm"));
}

}  // namespace
}  // namespace fettle::app
