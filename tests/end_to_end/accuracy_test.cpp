#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

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
  EXPECT_EQ(report["rows"].size(), 14U * 6U + 4U * 2U);
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), report["rows"].size() + 1);
  for (const char* file : {"contact.svg", "upload.svg"})
    EXPECT_GT(std::filesystem::file_size(folder.path() / "out" / file), 3000U) << file;
  EXPECT_TRUE(report["answers"].contains("contact"));
}

TEST(Accuracy, AStudyThatIsNoneIsRefusedBeforeAnythingIsMade) {
  const TempFolder folder;
  const Outcome outcome = fettle({"accuracy", folder.file("out"), "--only", "speed"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("speed is not one of contact"), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

// Its own environment is what a started program inherits.
class WithVariable {
 public:
  WithVariable(const char* name, const std::string& value) : name_(name) {
    const char* before = std::getenv(name);
    had_ = before != nullptr;
    if (had_) before_ = before;
    setenv(name, value.c_str(), 1);
  }
  ~WithVariable() {
    if (had_)
      setenv(name_, before_.c_str(), 1);
    else
      unsetenv(name_);
  }
  WithVariable(const WithVariable&) = delete;
  WithVariable& operator=(const WithVariable&) = delete;

 private:
  const char* name_;
  std::string before_;
  bool had_ = false;
};

TEST(Accuracy, WithoutGnuplotOrRoomForItsScriptNothingIsLeftAndALineSaysWhy) {
  const TempFolder folder;
  const std::vector<std::string> command{"accuracy", folder.file("out"), "--only",
                                         "upload",   "--effort",         "0.01"};
  {
    const WithVariable nothing_there("PATH", folder.file("nowhere"));
    const Outcome outcome = fettle(command);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_NE(outcome.err.find("install gnuplot-nox"), std::string::npos) << outcome.err;
  }
  const WithVariable no_room("TMPDIR", folder.file("nowhere"));
  const Outcome outcome = fettle(command);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("set TMPDIR"), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

}  // namespace
}  // namespace fettle::tests
