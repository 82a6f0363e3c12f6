#include "app/texts/format_fields.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

TEST(FormatFields, of_a_translation_may_come_in_another_order_or_be_left_out) {
  EXPECT_TRUE(fitsFields("{} of {}", "{} von {}"));
  EXPECT_TRUE(fitsFields("{} of {}", "{1}, davon {0}"));
  EXPECT_TRUE(fitsFields("{} of {}", "{}"));
  EXPECT_TRUE(fitsFields("{:.3g} {}", "{1} {0:.3g}"));
  EXPECT_TRUE(fitsFields("no field", "{{kein}} Feld"));
}

TEST(FormatFields, that_the_source_has_not_do_not_fit) {
  EXPECT_FALSE(fitsFields("{}", "{} {}"));
  EXPECT_FALSE(fitsFields("{}", "{1}"));
  EXPECT_FALSE(fitsFields("{:.3g} {}", "{1:.3g} {0}")) << "of another argument";
  EXPECT_FALSE(fitsFields("{}", "{:d}"));
  EXPECT_FALSE(fitsFields("{}", "{:{}}"));
  EXPECT_FALSE(fitsFields("no field", "{}"));
}

TEST(FormatFields, that_are_no_format_do_not_fit) {
  for (const char* text :
       {"{", "}", "{:", "{0", "{x}", "{0} {}", "{} {0}", "{-1}", "{99999999999999999999}", "{:{", "{:{}"})
    EXPECT_FALSE(fitsFields("{}", text)) << text;
}

TEST(FormatFields, with_fields_inside_fit_in_their_order_alone) {
  EXPECT_TRUE(fitsFields("{:.{}g} {}", "{:.{}g} von {}"));
  EXPECT_FALSE(fitsFields("{:.{}g} {}", "{} {:.{}g}"));
}

TEST(FormatFields, of_printf_are_the_same_in_the_same_order) {
  EXPECT_TRUE(sameConversions("%.2f samples", "%.2f Punkte"));
  EXPECT_TRUE(sameConversions("%.4g %%", "%.4g %%"));
  EXPECT_FALSE(sameConversions("%.2f samples", "%s Punkte"));
  EXPECT_FALSE(sameConversions("%.2f samples", "Punkte"));
  EXPECT_FALSE(sameConversions("%.2f samples", "%.2f %n"));
  EXPECT_FALSE(sameConversions("%.2f samples", "%.2f %"));
  EXPECT_FALSE(sameConversions("%.2f", "%*.2f"));
}

}  // namespace
}  // namespace fettle::app
