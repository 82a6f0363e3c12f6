#include <cstdio>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "render/png/png.h"
#include "tests/support/temp_folder.h"

namespace fettle::render {
namespace {

Image someImage() {
  Image image{37, 11, {}};
  for (int i = 0; i < 37 * 11 * 4; ++i)
    image.rgba.push_back(static_cast<std::uint8_t>(i % 4 == 3 ? 255 : i * 7));
  return image;
}

TEST(Png, EveryByteComesBack) {
  const tests::TempFolder folder;
  const Image image = someImage();
  ASSERT_TRUE(writePng(image, folder.file("a.png")));
  const engine::Result<Image> back = readPng(folder.file("a.png"));
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->width, 37);
  EXPECT_EQ(back->height, 11);
  EXPECT_EQ(back->rgba, image.rgba);
}

TEST(Png, AFileCutShortOrOfAnotherKindIsRefused) {
  const tests::TempFolder folder;
  ASSERT_TRUE(writePng(someImage(), folder.file("a.png")));
  std::filesystem::resize_file(folder.file("a.png"), std::filesystem::file_size(folder.file("a.png")) - 30);
  std::ofstream(folder.file("b.png")) << "not a picture";
  for (const char* name : {"a.png", "b.png", "missing.png"}) {
    const engine::Result<Image> image = readPng(folder.file(name));
    ASSERT_FALSE(image) << name;
    EXPECT_EQ(image.error().kind, engine::ErrorKind::kInput);
    EXPECT_EQ(image.error().where, folder.file(name));
  }
}

TEST(Png, AFolderThatIsNotThereIsAnInputErrorAndAnImageOfTheWrongSizeToo) {
  const tests::TempFolder folder;
  EXPECT_EQ(writePng(someImage(), folder.file("no/such/a.png")).error().kind, engine::ErrorKind::kInput);
  Image image = someImage();
  image.rgba.pop_back();
  EXPECT_FALSE(writePng(image, folder.file("a.png")));
  EXPECT_FALSE(std::filesystem::exists(folder.file("a.png")));
}

TEST(Png, RowsWrittenInBandsAreThePictureAndNoneMayBeMissing) {
  const tests::TempFolder folder;
  const Image image = someImage();
  const auto rows = [&](int first, int count) {
    const auto at = [](int row) { return std::ptrdiff_t{4} * 37 * row; };
    return Image{37, count, {image.rgba.begin() + at(first), image.rgba.begin() + at(first + count)}};
  };
  engine::Result<PngWriter> writer = PngWriter::create(folder.file("a.png"), 37, 11);
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->write(rows(0, 4)));
  ASSERT_TRUE(writer->write(rows(4, 6)));
  EXPECT_FALSE(writer->write(rows(0, 2)));  // one is left
  EXPECT_FALSE(writer->finish());
  EXPECT_FALSE(std::filesystem::exists(folder.file("a.png")));
  ASSERT_TRUE(writer->write(rows(10, 1)));
  ASSERT_TRUE(writer->finish());
  const engine::Result<Image> back = readPng(folder.file("a.png"));
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->rgba, image.rgba);
}

}  // namespace
}  // namespace fettle::render
