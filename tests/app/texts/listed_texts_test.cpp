// The list of texts is what scripts/texts makes of the sources, and every one of them can be translated.
#include <algorithm>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "app/texts/catalogue.h"
#include "tests/support/catalogue_file.h"
#include "tests/support/process.h"
#include "tests/support/source_tree.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

std::string contentOf(const std::string& path) {
  std::ostringstream content;
  content << std::ifstream(path).rdbuf();
  return content.str();
}

const std::string& list() {
  static const std::string path = tests::inSourceTree("assets/texts/fettle.pot");
  return path;
}

TEST(ListedTexts, are_those_of_the_sources) {
  if (tests::runProcess({"sh", "-c", "command -v xgettext msgcat && git -C \"$1\" rev-parse", "sh",
                         tests::inSourceTree(".")})
          .status != 0)
    GTEST_SKIP() << "gettext is not installed, or this is no checkout";
  const tests::TempFolder folder;
  const std::string now = folder.file("now.pot");
  const tests::Outcome made = tests::runProcess({tests::inSourceTree("scripts/texts"), now});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_TRUE(contentOf(now) == contentOf(list()))
      << "run scripts/texts: the sources have other texts than " << list();
}

TEST(ListedTexts, can_all_be_translated) {
  const std::vector<tests::ListedText> texts = tests::listedTexts(list());
  EXPECT_GT(texts.size(), 900);
  const auto read = Catalogue::parse(tests::pseudoCatalogue(list()), "pseudo.mo");
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(read->size(), texts.size());
  for (const std::string& refused : read->refused()) ADD_FAILURE() << refused;
  EXPECT_STREQ(read->find("Open a scan"), "[\u00d3p\u00e9n \u00e1 sc\u00e1n~~~]");
}

TEST(ListedTexts, have_no_id_of_a_widget) {
  for (const tests::ListedText& text : tests::listedTexts(list()))
    EXPECT_EQ(text.one.find("##"), std::string::npos) << text.one;
}

}  // namespace
}  // namespace fettle::app
