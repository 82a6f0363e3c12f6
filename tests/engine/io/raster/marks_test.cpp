#include "engine/io/raster/marks.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "engine/field/difference.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

std::vector<std::uint8_t> marksOf(const Version& field) {
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(field.grid().samples()));
  field.reader().readMarks(0, 0, field.grid().width, field.grid().height, marks.data(), field.grid().width);
  return marks;
}

class Marks : public ::testing::TestWithParam<const char*> {};

TEST_P(Marks, ComeBackOnFieldsOfOddSizesWithHeightsUntouched) {
  const TempFolder folder;
  for (const auto& [w, h] : {std::pair{1, 1}, {200, 131}, {64, 64}, {1, 300}, {300, 1}, {65, 129}}) {
    std::vector<float> z;
    std::vector<std::uint8_t> marks;
    for (int i = 0; i < w * h; ++i) {
      z.push_back(i % 13 == 5 ? kNan : static_cast<float>(i) * 0.1F);
      marks.push_back(i % 7 == 0 || i % 11 == 3);
    }
    const Version field = makeField(gridOf(w, h), z, marks);
    const std::string path = folder.file(std::string("m") + GetParam());
    const Status written = exportMarks(field, path);
    ASSERT_TRUE(written) << written.error().line();
    const Version bare = makeField(gridOf(w, h), z);
    const auto marked = importMarks(bare, path);
    ASSERT_TRUE(marked) << marked.error().line();
    EXPECT_EQ(marksOf(*marked), marks);
    EXPECT_EQ(contentHash(*marked), contentHash(field));
    EXPECT_EQ(summarize(*marked).marked, summarize(field).marked);
    // The same marks again share every tile.
    const auto again = importMarks(*marked, path);
    ASSERT_TRUE(again);
    EXPECT_TRUE(changedTiles(*marked, *again).empty());
  }
}

TEST_P(Marks, TheTopRowOfThePictureIsTheHighestRow) {
  const TempFolder folder;
  const std::string path = folder.file(std::string("m") + GetParam());
  ASSERT_TRUE(exportMarks(makeField(gridOf(2, 2), {0, 0, 0, 0}, {0, 0, 1, 0}), path));
  FETTLE_LOAD(picture, path);
  EXPECT_EQ(stored(picture.field, 0, 0), 255.0F);
  EXPECT_EQ(stored(picture.field, 1, 0), 0.0F);
}

TEST_P(Marks, OldMarksAreGoneAndTheSignStays) {
  const TempFolder folder;
  const std::string path = folder.file(std::string("m") + GetParam());
  ASSERT_TRUE(exportMarks(makeField(gridOf(2, 1), {0, 0}, {0, 1}), path));
  const Version field = makeField(gridOf(2, 1), {3, 4}, {1, 0}).inverted();
  const auto marked = importMarks(field, path);
  ASSERT_TRUE(marked);
  EXPECT_EQ(marksOf(*marked), (std::vector<std::uint8_t>{0, 1}));
  EXPECT_EQ(marked->reader().heightAt(0, 0), -3.0F);
  EXPECT_EQ(marksOf(field), (std::vector<std::uint8_t>{1, 0}));
}

TEST_P(Marks, AnotherSizeIsRefused) {
  const TempFolder folder;
  const std::string path = folder.file(std::string("m") + GetParam());
  ASSERT_TRUE(exportMarks(makeField(gridOf(3, 2), std::vector<float>(6, 0.0F)), path));
  const auto marked = importMarks(makeField(gridOf(2, 3), std::vector<float>(6, 0.0F)), path);
  ASSERT_FALSE(marked);
  EXPECT_EQ(marked.error().kind, ErrorKind::kInput);
  EXPECT_NE(marked.error().what.find("3 x 2"), std::string::npos);
}

TEST_P(Marks, AScanIsNotTakenForMarksNorACutFile) {
  const TempFolder folder;
  const std::string extension = GetParam();
  const Version field = makeField(gridOf(90, 70), std::vector<float>(90 * 70, 1.0F));
  ASSERT_TRUE(save(field, folder.file("scan" + extension)));
  const auto scan = importMarks(field, folder.file("scan" + extension));
  ASSERT_FALSE(scan);
  EXPECT_EQ(scan.error().kind, ErrorKind::kInput);
  ASSERT_TRUE(exportMarks(field, folder.file("m" + extension)));
  const std::string whole = readBytes(folder.file("m" + extension));
  for (std::size_t bytes = 0; bytes < whole.size() - 8; bytes += 7) {
    writeBytes(folder.file("cut" + extension), whole.substr(0, bytes));
    const auto cut = importMarks(field, folder.file("cut" + extension));
    if (cut) {
      EXPECT_EQ(contentHash(*cut), contentHash(field)) << bytes;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, Marks, ::testing::Values(".png", ".tif"));

TEST(MarksFiles, OtherExtensionsAndMissingFilesAreRefused) {
  const TempFolder folder;
  const Version field = makeField(gridOf(1, 1), {0.0F});
  EXPECT_FALSE(exportMarks(field, folder.file("m.asc")));
  EXPECT_FALSE(importMarks(field, folder.file("none.png")));
  writeBytes(folder.file("m.png"), "not a picture");
  EXPECT_FALSE(importMarks(field, folder.file("m.png")));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()),
                          std::filesystem::directory_iterator()),
            1);
}

}  // namespace
}  // namespace fettle::engine
