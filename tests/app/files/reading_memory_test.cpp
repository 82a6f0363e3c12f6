#include "app/files/reading_memory.h"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

ScanOptions reading(const std::string& unit, double spacing) {
  ScanOptions options;
  options.unit = unit;
  options.spacing = {spacing, spacing};
  return options;
}

TEST(ReadingMemory, keeps_what_was_said_of_each_file_for_the_next_run) {
  const tests::TempFolder folder;
  const std::string file = folder.file("readings.json");
  {
    ReadingMemory memory(file);
    memory.note("/a/one.tif", reading("um", 0.5));
    memory.note("/a/../b/two.tif", reading("nm", 20.0));
    memory.note("/a/one.tif", reading("um", 0.25));
  }
  ReadingMemory memory(file);
  EXPECT_EQ(scanOptionsText(memory.find("/a/one.tif").value()), " --spacing 0.25,0.25 --unit um");
  EXPECT_EQ(scanOptionsText(memory.find("/b/two.tif").value()), " --spacing 20,20 --unit nm");
  EXPECT_FALSE(memory.find("/a/three.tif"));
  memory.note("/b/two.tif", {});
  const auto as_it_is = ReadingMemory(file).find("/b/two.tif");
  ASSERT_TRUE(as_it_is) << "that a file is as it says was said, too";
  EXPECT_EQ(scanOptionsText(*as_it_is), "");
}

TEST(ReadingMemory, takes_no_more_than_so_many_and_forgets_the_oldest) {
  const tests::TempFolder folder;
  ReadingMemory memory(folder.file("readings.json"));
  for (std::size_t i = 0; i <= ReadingMemory::kMost; ++i)
    memory.note("/scan" + std::to_string(i), reading("mm", 1.0 + static_cast<double>(i)));
  EXPECT_FALSE(memory.find("/scan0"));
  EXPECT_TRUE(memory.find("/scan1"));
}

TEST(ReadingMemory, a_damaged_file_says_nothing) {
  const tests::TempFolder folder;
  const std::string file = folder.file("readings.json");
  for (const char* text :
       {"", "{", "[1, null, {}]", "[{\"path\": 3}]", "[{\"path\": \"/a\", \"spacing_x\": \"none\"}]",
        "[{\"path\": \"/a\", \"unit\": 7}]"}) {
    std::ofstream(file, std::ios::trunc) << text;
    const auto found = ReadingMemory(file).find("/a");
    EXPECT_TRUE(!found || scanOptionsText(*found).empty()) << text;
  }
}

}  // namespace
}  // namespace fettle::app
