#include "app/texts/texts.h"

#include <gtest/gtest.h>

#include "tests/support/catalogue_file.h"

namespace fettle::app {
namespace {

class Texts : public ::testing::Test {
 protected:
  void TearDown() override { useSourceTexts(); }
  static void use(const std::map<std::string, std::string>& texts) {
    auto read = Catalogue::parse(tests::catalogueBytes(texts), "test.mo");
    ASSERT_TRUE(read) << read.error().line();
    useTexts(*std::move(read));
  }
};

TEST_F(Texts, without_a_catalogue_are_those_of_the_source_themselves) {
  const char* const text = "Save";
  EXPECT_EQ(tr(text), text);
  EXPECT_EQ(labelOf("Save##2"), std::string("Save##2"));
  EXPECT_EQ(trFormat("{} of {}", 1, 2), "1 of 2");
  EXPECT_EQ(trPlural("{} step", "{} steps", 1, 1), "1 step");
  EXPECT_EQ(trPlural("{} step", "{} steps", 3, 3), "3 steps");
}

TEST_F(Texts, are_translated_and_formatted_in_the_order_of_the_language) {
  using namespace std::string_literals;
  use({{"Save", "Sichern"},
       {"{} of {}", "von {1} {0}"},
       {"{} step\0{} steps"s, "ein Schritt\0{} Schritte"s},
       {"%.2f samples", "%.2f Punkte"}});
  EXPECT_STREQ(tr("Save"), "Sichern");
  EXPECT_EQ(tr(std::string_view("Save")), "Sichern");
  EXPECT_STREQ(tr("Undo"), "Undo");
  EXPECT_EQ(trFormat("{} of {}", 1, 2), "von 2 1");
  EXPECT_EQ(trPlural("{} step", "{} steps", 1, 1), "ein Schritt");
  EXPECT_EQ(trPlural("{} step", "{} steps", 3, 3), "3 Schritte");
  EXPECT_STREQ(trPrintf("%.2f samples"), "%.2f Punkte");
}

TEST_F(Texts, whose_translation_takes_other_arguments_stay_as_in_the_source) {
  use({{"{} of {}", "{} {} {}"}, {"{:.3g} mm", "{:s} mm"}, {"%.2f samples", "%s%n"}});
  EXPECT_EQ(trFormat("{} of {}", 1, 2), "1 of 2");
  EXPECT_EQ(trFormat("{:.3g} mm", 1.5), "1.5 mm");
  EXPECT_STREQ(trPrintf("%.2f samples"), "%.2f samples");
}

TEST_F(Texts, of_labels_keep_the_id_of_the_source) {
  use({{"Save", "Sichern"}, {"Fit", "Einpassen"}});
  EXPECT_STREQ(labelOf("Save"), "Sichern###Save");
  EXPECT_STREQ(labelOf("Fit##2"), "Einpassen###Fit##2");
  EXPECT_STREQ(labelOf("Fit###one"), "Einpassen###one");
  EXPECT_STREQ(labelOf("##id"), "##id");
  EXPECT_STREQ(labelOf("Undo##3"), "Undo##3");
  const char* const first = labelOf("Save");
  for (int i = 0; i < 7; ++i) (void)labelOf("Fit");
  EXPECT_STREQ(first, "Sichern###Save") << "several are in use at once";
}

}  // namespace
}  // namespace fettle::app
