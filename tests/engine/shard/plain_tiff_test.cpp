#include "engine/io/tiff/plain_tiff.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "engine/formats/formats.h"
#include "tests/engine/shard/shard_field.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

std::string bytesOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class PlainTiff : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(PlainTiff, rows_written_in_any_order_make_the_file_of_an_export) {
  const auto [width, height] = GetParam();
  const tests::TempFolder folder;
  const Version field = tests::hardField(width, height);
  JobControl job;
  ASSERT_TRUE(exportField(field, folder.file("whole.tif"), {}, job));
  const auto layout = createPlainTiff(field.grid(), folder.file("rows.tif"));
  ASSERT_TRUE(layout) << layout.error().line();
  EXPECT_EQ(layout->bytes, std::filesystem::file_size(folder.file("whole.tif")));
  for (const int first : {1, 0})
    for (int row = first; row < height; row += 2) {
      auto rows = PlainRows::open(folder.file("rows.tif"), *layout);
      ASSERT_TRUE(rows) << rows.error().line();
      std::vector<float> z(static_cast<std::size_t>(width)), back(z.size());
      field.reader().readHeights(0, row, width, 1, z.data(), width);
      ASSERT_TRUE(rows->write(row, 1, z.data()));
      ASSERT_TRUE(rows->read(row, 1, back.data()));
      ASSERT_EQ(std::memcmp(back.data(), z.data(), z.size() * sizeof(float)), 0);
      if (row < 2) {
        ASSERT_TRUE(rows->flush());
      }
    }
  EXPECT_TRUE(bytesOf(folder.file("rows.tif")) == bytesOf(folder.file("whole.tif")));
}

// One strip, several, of more rows than one, and rows that are longer than a strip.
INSTANTIATE_TEST_SUITE_P(Sizes, PlainTiff,
                         testing::Values(std::pair{1, 1}, std::pair{33, 70}, std::pair{1500, 700},
                                         std::pair{270000 / 2, 3}));

TEST(PlainTiffFile, without_a_folder_or_of_another_size_is_an_error) {
  const tests::TempFolder folder;
  Grid grid;
  grid.width = grid.height = 10;
  EXPECT_EQ(createPlainTiff(grid, folder.file("none/x.tif")).error().kind, ErrorKind::kInput);
  const auto layout = createPlainTiff(grid, folder.file("cut.tif"));
  ASSERT_TRUE(layout);
  std::filesystem::resize_file(folder.file("cut.tif"), layout->bytes - 1);
  EXPECT_EQ(PlainRows::open(folder.file("cut.tif"), *layout).error().kind, ErrorKind::kInput);
}

TEST(PlainTiffFile, on_a_full_disk_is_an_error_that_says_so) {
  // Of no bytes, as a device is.
  auto rows = PlainRows::open("/dev/full", PlainLayout{10, 10, 0, 0});
  ASSERT_TRUE(rows) << rows.error().line();
  const std::vector<float> heights(20);
  const Status written = rows->write(3, 2, heights.data());
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ErrorKind::kFailed);
  EXPECT_NE(written.error().line().find("the disk is full"), std::string::npos) << written.error().line();
}

TEST(PlainTiffFile, that_the_system_does_not_open_is_not_called_missing) {
  const tests::TempFolder folder;
  Grid grid;
  grid.width = grid.height = 10;
  const std::string path = folder.file("rows.tif");
  const auto layout = createPlainTiff(grid, path);
  ASSERT_TRUE(layout);
  EXPECT_EQ(PlainRows::open(folder.file("none.tif"), *layout).error().kind, ErrorKind::kInput);
  EXPECT_EQ(layoutOfPlainTiff(folder.file("none.tif"), 10, 10).error().kind, ErrorKind::kInput);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit none = before;
  none.rlim_cur = 0;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  const auto rows = PlainRows::open(path, *layout);
  const auto found = layoutOfPlainTiff(path, 10, 10);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  ASSERT_FALSE(rows);
  ASSERT_FALSE(found);
  EXPECT_EQ(rows.error().kind, ErrorKind::kFailed) << rows.error().line();
  EXPECT_EQ(found.error().kind, ErrorKind::kFailed) << found.error().line();
}

}  // namespace
}  // namespace fettle::engine
