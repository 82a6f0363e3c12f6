#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

std::string contentOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(Accuracy, WritesAPageThatNeedsNothingBesideItAndTheSameFiguresAsCsv) {
  const TempFolder folder;
  ASSERT_EQ(fettleJson({"synth", folder.file("part & co.tif"), "--size", "200x200"})["width"], 200);
  const auto report = fettleJson({"accuracy", folder.file("out"), folder.file("part & co.tif"), "--effort",
                                  "0.01", "--only", "contact", "--only", "upload"});
  const std::string page = contentOf(folder.file("out") + "/accuracy.html");
  const std::string csv = contentOf(folder.file("out") + "/accuracy.csv");
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_NE(page.find("part &amp; co.tif"), std::string::npos);
  EXPECT_EQ(page.find("part & co.tif"), std::string::npos);
  EXPECT_EQ(page.find("http://"), page.find("http://www.w3.org")) << "something is fetched";
  // Levels on five made fields and the scan; ways to keep a sample on the part and the scan.
  EXPECT_EQ(report["rows"].size(), 9U * 6U + 4U * 2U);
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), report["rows"].size() + 1);
  for (const char* file : {"contact.svg", "upload.svg"})
    EXPECT_GT(std::filesystem::file_size(folder.path() / "out" / file), 3000U) << file;
  EXPECT_TRUE(report["answers"].contains("contact"));
}

TEST(Accuracy, AStudyThatIsNoneIsRefusedBeforeAnythingIsMade) {
  const TempFolder folder;
  const Outcome outcome = fettle({"accuracy", folder.file("out"), "--only", "speed"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("there is no study \"speed\""), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

}  // namespace
}  // namespace fettle::tests
