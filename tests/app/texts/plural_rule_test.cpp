#include "app/texts/plural_rule.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

std::vector<std::size_t> formsOf(const std::string& header, const std::vector<unsigned long long>& numbers) {
  const auto rule = PluralRule::read(header);
  if (!rule) return {};
  std::vector<std::size_t> forms;
  for (const unsigned long long n : numbers) forms.push_back(rule->formOf(n));
  return forms;
}

using Forms = std::vector<std::size_t>;

// The rules of the gettext manual, "Plural forms".
TEST(PluralRule, of_languages_gives_the_form_of_a_number) {
  EXPECT_EQ(formsOf("nplurals=2; plural=n != 1;", {0, 1, 2}), (Forms{1, 0, 1}));
  EXPECT_EQ(formsOf("nplurals=1; plural=0;", {0, 1, 2}), (Forms{0, 0, 0}));
  EXPECT_EQ(formsOf("nplurals=2; plural=n>1;", {0, 1, 2}), (Forms{0, 0, 1}));
  EXPECT_EQ(formsOf("nplurals=3; plural=n%10==1 && n%100!=11 ? 0 : n%10>=2 && n%10<=4 && (n%100<10 || "
                    "n%100>=20) ? 1 : 2;",
                    {1, 2, 5, 11, 12, 21, 22, 25, 111}),
            (Forms{0, 1, 2, 2, 2, 0, 1, 2, 2}));
  EXPECT_EQ(formsOf("nplurals=6; plural=n==0 ? 0 : n==1 ? 1 : n==2 ? 2 : n%100>=3 && n%100<=10 ? 3 : "
                    "n%100>=11 ? 4 : 5;",
                    {0, 1, 2, 3, 11, 100}),
            (Forms{0, 1, 2, 3, 4, 5}));
}

TEST(PluralRule, without_a_header_is_that_of_english) {
  EXPECT_EQ(PluralRule().formOf(1), 0);
  EXPECT_EQ(PluralRule().formOf(7), 1);
}

TEST(PluralRule, never_gives_a_form_that_there_is_not_nor_divides_by_zero) {
  EXPECT_EQ(formsOf("nplurals=2; plural=n;", {0, 1, 2, ~0ULL}), (Forms{0, 1, 1, 1}));
  EXPECT_EQ(formsOf("nplurals=2; plural=1/(n-n);", {5}), (Forms{0}));
  EXPECT_EQ(formsOf("nplurals=2; plural=n%0;", {5}), (Forms{0}));
}

TEST(PluralRule, that_does_not_read_as_one_is_refused) {
  for (const std::string& header :
       {std::string(), std::string("plural=n;"), std::string("nplurals=2;"),
        std::string("nplurals=0; plural=0;"), std::string("nplurals=17; plural=0;"),
        std::string("nplurals=x; plural=0;"), std::string("nplurals=2; plural=;"),
        std::string("nplurals=2; plural=n!;"), std::string("nplurals=2; plural=n?1;"),
        std::string("nplurals=2; plural=(n;"), std::string("nplurals=2; plural=m;"),
        "nplurals=2; plural=" + std::string(200, '(') + "n" + std::string(200, ')') + ";",
        "nplurals=2; plural=" + std::string(1000, '!') + "n;"})
    EXPECT_FALSE(PluralRule::read(header)) << header;
}

}  // namespace
}  // namespace fettle::app
