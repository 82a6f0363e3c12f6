#include "app/files/folder_listing.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

void writeBytes(const std::string& path, std::size_t bytes) {
  std::ofstream(path) << std::string(bytes, 'x');
}

std::vector<std::string> namesOf(const FolderListing& listing, const FolderView& view) {
  std::vector<std::string> names;
  for (const std::size_t i : shownEntries(listing, view)) names.push_back(listing.entries[i].name);
  return names;
}

using Names = std::vector<std::string>;

class FolderListingTest : public ::testing::Test {
 protected:
  FolderListingTest() {
    fs::create_directory(folder.path() / "runs");
    writeBytes(folder.file("part10.tif"), 10);
    writeBytes(folder.file("part2.TIF"), 300);
    writeBytes(folder.file("notes.odt"), 20);
    writeBytes(folder.file(".hidden.tif"), 1);
    const auto now = fs::file_time_type::clock::now();
    fs::last_write_time(folder.file("part10.tif"), now - std::chrono::hours(1));
    fs::last_write_time(folder.file("part2.TIF"), now - std::chrono::hours(2));
    engine::JobControl job;
    listing = listFolder(folder.path().string(), job).value();
  }
  tests::TempFolder folder;
  FolderListing listing;
};

TEST_F(FolderListingTest, shows_folders_and_scans_by_name_as_people_count) {
  EXPECT_EQ(listing.folder, folder.path().string());
  EXPECT_EQ(namesOf(listing, {}), (Names{"runs", "part2.TIF", "part10.tif"}));
  EXPECT_EQ(namesOf(listing, {.descending = true}), (Names{"runs", "part10.tif", "part2.TIF"}));
}

TEST_F(FolderListingTest, orders_by_size_and_date_and_filters) {
  EXPECT_EQ(namesOf(listing, {.order = FolderOrder::kSize}), (Names{"runs", "part10.tif", "part2.TIF"}));
  EXPECT_EQ(namesOf(listing, {.order = FolderOrder::kChanged}), (Names{"runs", "part2.TIF", "part10.tif"}));
  EXPECT_EQ(namesOf(listing, {.order = FolderOrder::kChanged, .descending = true}),
            (Names{"runs", "part10.tif", "part2.TIF"}));
  EXPECT_EQ(namesOf(listing, {.typed = "PART1"}), (Names{"part10.tif"}));
  EXPECT_EQ(namesOf(listing, {.all_files = true}), (Names{"runs", "notes.odt", "part2.TIF", "part10.tif"}));
  EXPECT_EQ(namesOf(listing, {.endings = {".odt"}}), (Names{"runs", "notes.odt"}));
  EXPECT_EQ(namesOf(listing, {.endings = {".png", ".tif"}}), (Names{"runs", "part2.TIF", "part10.tif"}));
  EXPECT_EQ(namesOf(listing, {.all_files = true, .endings = {".png"}}).size(), 4U);
  EXPECT_EQ(namesOf(listing, {.hidden = true}), (Names{"runs", ".hidden.tif", "part2.TIF", "part10.tif"}));
}

TEST_F(FolderListingTest, knows_sizes_dates_and_kinds) {
  for (const FolderEntry& entry : listing.entries) {
    EXPECT_EQ(entry.folder, entry.name == "runs");
    if (entry.name == "part2.TIF") {
      EXPECT_TRUE(entry.scan);
      EXPECT_EQ(entry.bytes, 300U);
      const auto age =
          std::chrono::system_clock::now() - std::chrono::system_clock::from_time_t(entry.changed_s);
      EXPECT_NEAR(std::chrono::duration<double>(age).count(), 7200.0, 60.0);
    }
    if (entry.name == "notes.odt") {
      EXPECT_FALSE(entry.scan);
    }
  }
}

TEST_F(FolderListingTest, a_link_to_nowhere_is_listed_and_what_is_no_folder_is_an_error) {
  fs::create_symlink(folder.path() / "gone", folder.path() / "link.tif");
  engine::JobControl job;
  const auto again = listFolder(folder.path().string() + "/", job);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->folder, folder.path().string());
  EXPECT_EQ(namesOf(*again, {.typed = "link"}), (Names{"link.tif"}));
  const auto none = listFolder(folder.file("part10.tif"), job);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, engine::ErrorKind::kInput);
  EXPECT_EQ(none.error().where, folder.file("part10.tif"));
  job.cancel();
  EXPECT_EQ(listFolder(folder.path().string(), job).error().kind, engine::ErrorKind::kCancelled);
}

TEST_F(FolderListingTest, ten_thousand_entries_are_all_there) {
  for (int i = 0; i < 10000; ++i) writeBytes(folder.file("runs/" + std::to_string(i) + ".tif"), 0);
  engine::JobControl job;
  const auto many = listFolder(folder.file("runs"), job);
  ASSERT_TRUE(many);
  const Names names = namesOf(*many, {});
  ASSERT_EQ(names.size(), 10000U);
  for (std::size_t i = 0; i < names.size(); ++i) ASSERT_EQ(names[i], std::to_string(i) + ".tif");
}

TEST(ComesBefore, is_an_order_for_numbers_of_any_length_zeros_and_case) {
  const Names ordered{"",  "1",  "01", "2a",  "10", "99999999999999999999", "100000000000000000000",
                      "A", "a1", "a2", "A10", "b"};
  for (std::size_t i = 0; i < ordered.size(); ++i)
    for (std::size_t j = 0; j < ordered.size(); ++j) {
      const bool equal_but_for_bytes = ordered[i].ends_with('1') && ordered[j].ends_with('1') && i != j &&
                                       std::max(i, j) == 2;  // "1" and "01": bytes decide
      if (equal_but_for_bytes)
        EXPECT_NE(comesBefore(ordered[i], ordered[j]), comesBefore(ordered[j], ordered[i]));
      else
        EXPECT_EQ(comesBefore(ordered[i], ordered[j]), i < j) << ordered[i] << " " << ordered[j];
    }
}

}  // namespace
}  // namespace fettle::app
