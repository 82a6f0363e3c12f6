// Links of the documents of the source tree, from file to file and to headings.

#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/docs/markdown_links.h"
#include "tests/support/source_tree.h"

namespace fettle::tests {
namespace {

namespace fs = std::filesystem;

bool readTree(const std::string& path, std::string* text) {
  const fs::path file = inSourceTree(path);
  if (!fs::exists(file)) return false;
  if (fs::is_directory(file)) return true;
  std::ifstream in(file);
  text->assign(std::istreambuf_iterator<char>(in), {});
  return true;
}

std::vector<std::string> documents() {
  std::vector<std::string> found{"README.md", "CONTRIBUTING.md", "CHANGELOG.md"};
  for (const auto& entry : fs::recursive_directory_iterator(inSourceTree("docs")))
    if (entry.path().extension() == ".md")
      found.push_back(fs::relative(entry.path(), inSourceTree("")).generic_string());
  return found;
}

TEST(Links, EveryLinkOfEveryDocumentLeadsToAFileAndToAHeadingOfIt) {
  int checked = 0;
  for (const std::string& document : documents()) {
    std::string text;
    ASSERT_TRUE(readTree(document, &text)) << document;
    for (const std::string& target : linksOf(text)) {
      const std::string problem = problemOf(document, target, readTree);
      EXPECT_EQ(problem, "");
      ++checked;
    }
  }
  EXPECT_GT(checked, 150);
}

// So that documents are found by reading from the first page on, as the site's sidebar is made of it.
TEST(Links, TheFirstPageOrTheListOfDecisionsNamesEveryPage) {
  std::set<std::string> named{"docs/README.md"};
  for (const std::string index : {"docs/README.md", "docs/decisions/README.md"}) {
    std::string text;
    ASSERT_TRUE(readTree(index, &text));
    for (const std::string& target : linksOf(text))
      named.insert((fs::path(index).parent_path() / target).lexically_normal().string());
  }
  for (const std::string& document : documents())
    EXPECT_TRUE(named.contains(document) || document == "README.md") << document;
}

TEST(Links, OnesInCodeAndCommentsAreNone) {
  EXPECT_EQ(
      linksOf(
          "a [b](c.md) `[d](e)` ` ```x ` ``[y](`z)`` ![f](g.png)\n```\n[h](i)\n```\n<!-- [j](k) --> [l](#m)"),
      (std::vector<std::string>{"c.md", "g.png", "#m"}));
}

TEST(Links, AnchorsOfHeadingsAreThoseOfGitHub) {
  EXPECT_EQ(anchorsOf("# One `two`, three: --four\ntext\n## Same\n```\n# no\n```\n## Same\n#none"),
            (std::set<std::string>{"one-two-three---four", "same", "same-1"}));
}

TEST(Links, AWrongFileAndAWrongHeadingAreReported) {
  const auto read = [](const std::string& path, std::string* text) {
    *text = "# Here\n";
    return path == "docs/a.md" || path == "b.md";
  };
  EXPECT_EQ(problemOf("docs/a.md", "#here", read), "");
  EXPECT_EQ(problemOf("docs/a.md", "../b.md#here", read), "");
  EXPECT_EQ(problemOf("docs/a.md", "https://example.org/none", read), "");
  EXPECT_EQ(problemOf("docs/a.md", "b.md", read), "docs/a.md: b.md: there is no docs/b.md");
  EXPECT_EQ(problemOf("docs/a.md", "../b.md#there", read),
            "docs/a.md: ../b.md#there: b.md has no such heading");
}

}  // namespace
}  // namespace fettle::tests
